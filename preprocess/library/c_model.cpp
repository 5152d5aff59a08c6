// Errors, models and baking in C (mdk.h).
#include <algorithm>
#include <atomic>
#include <memory>
#include <vector>

#include "mdk/bake.h"
#include "preprocess/library/c_call.h"

namespace mdk::c {
namespace {

thread_local std::string last_error;

void copy(const Aabb& box, float (&low)[3], float (&high)[3]) {
  for (std::size_t k = 0; k < 3; ++k) {
    low[k] = box.lo[k];
    high[k] = box.hi[k];
  }
}

mdk_model* make_model(const Model& model) {
  auto made = std::make_unique<mdk_model>(model);
  for (std::uint32_t c = 0; c < model.clip_count(); ++c)
    made->clip_names.push_back(model.clip(c).name);
  return made.release();
}

}  // namespace

void set_last_error(const char* sentence) noexcept {
  try {
    last_error = sentence;
  } catch (...) {
    last_error.clear();
  }
}

}  // namespace mdk::c

using mdk::c::call;
using mdk::c::refuse;
using mdk::c::require;

const char* mdk_last_error(void) { return mdk::c::last_error.c_str(); }
const char* mdk_version(void) { return MDK_VERSION; }

mdk_status mdk_model_load(const char* path, mdk_model** model) {
  return call([&] {
    require(path, "path");
    require(model, "model");
    *model = mdk::c::make_model(mdk::Model::load(path));
  });
}

void mdk_model_retain(mdk_model* model) {
  if (model != nullptr) ++model->users;
}
void mdk_model_release(mdk_model* model) {
  if (model != nullptr && --model->users == 0) delete model;
}

mdk_status mdk_model_save(const mdk_model* model, const char* path) {
  return call([&] {
    require(model, "model");
    require(path, "path");
    mdk::save(model->model, path);
  });
}

void mdk_model_info_init(mdk_model_info* info) {
  if (info == nullptr) return;
  *info = {};
  info->struct_size = sizeof *info;
}
void mdk_clip_info_init(mdk_clip_info* info) {
  if (info == nullptr) return;
  *info = {};
  info->struct_size = sizeof *info;
}

mdk_status mdk_model_get_info(const mdk_model* model, mdk_model_info* info) {
  return call([&] {
    require(model, "model");
    const mdk::Model& m = model->model;
    mdk_model_info full{};
    full.vertex_count = m.vertex_count();
    full.triangle_count = m.triangle_count();
    full.key_count = m.key_count();
    full.clip_count = m.clip_count();
    full.cluster_count = m.cluster_count();
    full.material_count = m.material_count();
    mdk::c::copy(m.bounds(), full.bounds_low, full.bounds_high);
    mdk::c::write_struct(full, info, "info");
  });
}

mdk_status mdk_model_get_clip(const mdk_model* model, uint32_t clip, mdk_clip_info* info) {
  return call([&] {
    require(model, "model");
    const mdk::ClipInfo found = model->model.clip(clip);
    mdk_clip_info full{};
    full.name = model->clip_names[clip].c_str();
    full.seconds = found.seconds;
    full.first_key = found.first_key;
    full.key_count = found.key_count;
    mdk::c::copy(model->model.clip_bounds(clip), full.bounds_low, full.bounds_high);
    mdk::c::write_struct(full, info, "info");
  });
}

mdk_status mdk_model_find_clip(const mdk_model* model, const char* name, uint32_t* clip) {
  return call([&] {
    require(model, "model");
    require(name, "name");
    require(clip, "clip");
    const auto found = model->model.find_clip(name);
    if (!found) {
      std::string names;
      for (const std::string& known : model->clip_names)
        names += (names.empty() ? "" : ", ") + known;
      refuse("the model has no clip \"" + std::string(name) + "\": it has " + names);
    }
    *clip = *found;
  });
}

mdk_status mdk_model_get_key_times(const mdk_model* model, uint32_t clip, double* seconds) {
  return call([&] {
    require(model, "model");
    require(seconds, "seconds");
    const mdk::ClipInfo found = model->model.clip(clip);
    for (uint32_t k = 0; k < found.key_count; ++k)
      seconds[k] = model->model.key_time(found.first_key + k);
  });
}

mdk_status mdk_model_get_material_color(const mdk_model* model, uint32_t material, float* rgba) {
  return call([&] {
    require(model, "model");
    require(rgba, "rgba");
    const std::array<float, 4> color = model->model.material_color(material);
    std::copy(color.begin(), color.end(), rgba);
  });
}

mdk_status mdk_model_get_faces(const mdk_model* model, uint32_t* faces) {
  return call([&] {
    require(model, "model");
    require(faces, "faces");
    for (uint32_t t = 0; t < model->model.triangle_count(); ++t)
      for (const uint32_t v : model->model.triangle(t)) *faces++ = v;
  });
}

mdk_status mdk_model_get_source_triangles(const mdk_model* model, uint32_t* triangles) {
  return call([&] {
    require(model, "model");
    require(triangles, "triangles");
    for (uint32_t t = 0; t < model->model.triangle_count(); ++t)
      triangles[t] = model->model.source_triangle(t);
  });
}

mdk_status mdk_model_get_vertices(const mdk_model* model, uint32_t clip, double seconds,
                                  mdk_wrap wrap, float* xyz) {
  return call([&] {
    require(model, "model");
    require(xyz, "xyz");
    const auto time = model->model.locate_time(clip, seconds, mdk::c::wrap_of(wrap));
    for (const mdk::Vec3f& p : model->model.vertices(time)) {
      *xyz++ = p.x;
      *xyz++ = p.y;
      *xyz++ = p.z;
    }
  });
}

mdk_status mdk_model_prepare(mdk_model* model) {
  return call([&] {
    require(model, "model");
    model->query();
  });
}
mdk_status mdk_model_get_ray_bytes(mdk_model* model, size_t* bytes) {
  return call([&] {
    require(model, "model");
    require(bytes, "bytes");
    *bytes = model->query().bytes();
  });
}

void mdk_mesh_init(mdk_mesh* mesh, size_t key_count, size_t vertex_count, size_t face_count,
                   const float* vertices, const uint32_t* faces) {
  if (mesh == nullptr) return;
  *mesh = {};
  mesh->struct_size = sizeof *mesh;
  mesh->key_count = key_count;
  mesh->vertex_count = vertex_count;
  mesh->face_count = face_count;
  mesh->vertices = vertices;
  mesh->faces = faces;
  mesh->fps = 30;
}

void mdk_bake_options_init(mdk_bake_options* options) {
  if (options == nullptr) return;
  *options = {};
  options->struct_size = sizeof *options;
}

mdk_status mdk_bake(const mdk_mesh* mesh, const mdk_bake_options* options, mdk_model** model) {
  return call([&] {
    require(model, "model");
    const mdk_mesh given = mdk::c::read_struct(mesh, "mesh");
    mdk::BakeMesh request;
    request.key_count = given.key_count;
    request.vertex_count = given.vertex_count;
    request.triangle_count = given.face_count;
    request.vertices = given.vertices;
    request.triangles = given.faces;
    request.key_times = given.key_times;
    request.fps = given.fps;
    if (given.clip_name != nullptr) request.clip_name = given.clip_name;
    mdk::BakeOptions choice;
    if (options != nullptr) {
      const mdk_bake_options chosen = mdk::c::read_struct(options, "options");
      choice.clusters = chosen.clusters;
      choice.segments = chosen.segments;
      choice.quantize = chosen.quantize;
      choice.threads = chosen.threads;
    }
    *model = mdk::c::make_model(mdk::bake(request, choice));
  });
}
