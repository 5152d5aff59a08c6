// The extension under the module mdk: arrays in and out of the C functions of mdk.h, with the GIL
// released while they run. What shapes, names and defaults mean is decided in _model.py.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "mdk/mdk.h"

namespace py = pybind11;

namespace {

using Floats = py::array_t<float, 0>;
using Doubles = py::array_t<double, 0>;

/// mdk.Error, and the exceptions of Python for what they are made for.
[[noreturn]] void fail(mdk_status status) {
  const std::string sentence = mdk_last_error();
  if (status == MDK_ERROR_IO) {
    PyErr_SetString(PyExc_OSError, sentence.c_str());
    throw py::error_already_set();
  }
  if (status == MDK_ERROR_USAGE || status == MDK_ERROR_BAD_INPUT || status == MDK_ERROR_OVER_LIMIT)
    throw py::value_error(sentence);
  throw std::runtime_error(sentence);
}
void check(mdk_status status) {
  if (status != MDK_OK) fail(status);
}

/// Items of an array as the C functions take them: one for all (shape (...)), or one each.
template <class Array>
std::size_t stride_of(const Array& array, py::ssize_t item_dimensions) {
  return array.ndim() == item_dimensions ? 0 : static_cast<std::size_t>(array.strides(0));
}

template <class T>
py::array_t<T> make(std::vector<py::ssize_t> shape) {
  return py::array_t<T>(std::move(shape));
}

/// The lists of hits that are wanted, made here and filled there.
class HitArrays {
 public:
  HitArrays(const py::iterable& want, std::size_t count) {
    mdk_hits_init(&hits);
    for (const py::handle& name : want)
      add(name.cast<std::string>(), static_cast<py::ssize_t>(count));
  }
  mdk_hits hits;
  py::dict arrays;

 private:
  template <class T>
  T* add(const std::string& name, std::vector<py::ssize_t> shape) {
    py::array_t<T> array(std::move(shape));
    T* data = array.mutable_data();
    arrays[py::str(name)] = std::move(array);
    return data;
  }
  void add(const std::string& name, py::ssize_t n) {
    if (name == "t")
      hits.t = add<float>(name, {n});
    else if (name == "triangle")
      hits.triangle = add<std::uint32_t>(name, {n});
    else if (name == "source_triangle")
      hits.source_triangle = add<std::uint32_t>(name, {n});
    else if (name == "uv")
      hits.uv = add<float>(name, {n, 2});
    else if (name == "position")
      hits.position = add<float>(name, {n, 3});
    else if (name == "normal")
      hits.normal = add<float>(name, {n, 3});
    else if (name == "smooth_normal")
      hits.smooth_normal = add<float>(name, {n, 3});
    else if (name == "velocity")
      hits.velocity = add<float>(name, {n, 3});
    else if (name == "texcoord")
      hits.texcoord = add<float>(name, {n, 2});
    else if (name == "material")
      hits.material = add<std::uint32_t>(name, {n});
    else if (name == "base_color")
      hits.base_color = add<float>(name, {n, 4});
    else if (name == "instance")
      hits.instance = add<std::uint32_t>(name, {n});
    else if (name == "id")
      hits.id = add<std::int64_t>(name, {n});
    else
      throw py::value_error("want: there is no \"" + name + "\"");
  }
};

class Model {
 public:
  explicit Model(mdk_model* model) : model_(model) {}
  ~Model() { mdk_model_release(model_); }
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  static Model* load(const std::string& path) {
    mdk_model* model = nullptr;
    mdk_status status;
    {
      const py::gil_scoped_release release;
      status = mdk_model_load(path.c_str(), &model);
    }
    check(status);
    return new Model(model);
  }

  static Model* bake(const py::array_t<float, py::array::c_style>& vertices,
                     const py::array_t<std::uint32_t, py::array::c_style>& faces,
                     const py::object& times, double fps, const std::string& clip,
                     std::uint32_t clusters, std::uint32_t segments, double quantize,
                     std::uint32_t threads) {
    mdk_mesh mesh;
    mdk_mesh_init(&mesh, static_cast<std::size_t>(vertices.shape(0)),
                  static_cast<std::size_t>(vertices.shape(1)),
                  static_cast<std::size_t>(faces.shape(0)), vertices.data(), faces.data());
    py::array_t<double, py::array::c_style> key_times;
    if (!times.is_none()) {
      key_times = times.cast<py::array_t<double, py::array::c_style>>();
      mesh.key_times = key_times.data();
    }
    mesh.fps = fps;
    mesh.clip_name = clip.c_str();
    mdk_bake_options options;
    mdk_bake_options_init(&options);
    options.clusters = clusters;
    options.segments = segments;
    options.quantize = quantize;
    options.threads = threads;
    mdk_model* model = nullptr;
    mdk_status status;
    {
      const py::gil_scoped_release release;
      status = mdk_bake(&mesh, &options, &model);
    }
    check(status);
    return new Model(model);
  }

  void save(const std::string& path) const {
    mdk_status status;
    {
      const py::gil_scoped_release release;
      status = mdk_model_save(model_, path.c_str());
    }
    check(status);
  }

  py::dict info() const {
    mdk_model_info info;
    mdk_model_info_init(&info);
    check(mdk_model_get_info(model_, &info));
    py::dict d;
    d["vertices"] = info.vertex_count;
    d["triangles"] = info.triangle_count;
    d["keys"] = info.key_count;
    d["clips"] = info.clip_count;
    d["clusters"] = info.cluster_count;
    d["materials"] = info.material_count;
    d["bounds"] = bounds(info.bounds_low, info.bounds_high);
    return d;
  }
  py::tuple clip(std::uint32_t index) const {
    mdk_clip_info info;
    mdk_clip_info_init(&info);
    check(mdk_model_get_clip(model_, index, &info));
    auto times = make<double>({static_cast<py::ssize_t>(info.key_count)});
    check(mdk_model_get_key_times(model_, index, times.mutable_data()));
    return py::make_tuple(info.name, info.seconds, info.first_key, times,
                          bounds(info.bounds_low, info.bounds_high));
  }
  py::array faces() const {
    auto faces = make<std::uint32_t>({count(&mdk_model_info::triangle_count), 3});
    check(mdk_model_get_faces(model_, faces.mutable_data()));
    return faces;
  }
  py::array source_triangles() const {
    auto list = make<std::uint32_t>({count(&mdk_model_info::triangle_count)});
    check(mdk_model_get_source_triangles(model_, list.mutable_data()));
    return list;
  }
  py::array material_colors() const {
    const py::ssize_t n = count(&mdk_model_info::material_count);
    auto list = make<float>({n, 4});
    for (py::ssize_t i = 0; i < n; ++i)
      check(mdk_model_get_material_color(model_, static_cast<std::uint32_t>(i),
                                         list.mutable_data() + 4 * i));
    return list;
  }
  py::array vertices(std::uint32_t clip, double seconds, mdk_wrap wrap) const {
    auto xyz = make<float>({count(&mdk_model_info::vertex_count), 3});
    float* data = xyz.mutable_data();
    mdk_status status;
    {
      const py::gil_scoped_release release;
      status = mdk_model_get_vertices(model_, clip, seconds, wrap, data);
    }
    check(status);
    return xyz;
  }
  void prepare() {
    const py::gil_scoped_release release;
    mdk_model_prepare(model_);
  }
  std::size_t ray_bytes() {
    std::size_t bytes = 0;
    check(mdk_model_get_ray_bytes(model_, &bytes));
    return bytes;
  }

  /// A list is one item for all rays, or one for each of `count`.
  struct RayLists {
    RayLists(std::size_t count, Floats o, Floats d, Floats lo, Floats hi, Doubles at,
             std::uint32_t clip, mdk_wrap wrap, std::uint32_t threads)
        : origins(std::move(o)),
          directions(std::move(d)),
          t_min(std::move(lo)),
          t_max(std::move(hi)),
          times(std::move(at)) {
      mdk_rays_init(&rays, count, origins.data(), directions.data());
      rays.t_min = t_min.data();
      rays.t_max = t_max.data();
      rays.times = times.data();
      rays.origin_stride = stride_of(origins, 1);
      rays.direction_stride = stride_of(directions, 1);
      rays.t_min_stride = stride_of(t_min, 0);
      rays.t_max_stride = stride_of(t_max, 0);
      rays.time_stride = stride_of(times, 0);
      rays.clip = clip;
      rays.wrap = wrap;
      rays.threads = threads;
    }
    Floats origins, directions, t_min, t_max;
    Doubles times;
    mdk_rays rays;
  };

  py::dict cast(const RayLists& lists, const py::iterable& want) {
    HitArrays out(want, lists.rays.count);
    mdk_status status;
    {
      const py::gil_scoped_release release;
      status = mdk_cast(model_, &lists.rays, &out.hits);
    }
    check(status);
    return out.arrays;
  }
  py::array occluded(const RayLists& lists) {
    auto list = make<std::uint8_t>({static_cast<py::ssize_t>(lists.rays.count)});
    std::uint8_t* data = list.mutable_data();
    mdk_status status;
    {
      const py::gil_scoped_release release;
      status = mdk_occluded(model_, &lists.rays, data);
    }
    check(status);
    return list;
  }
  py::tuple all_hits(const RayLists& lists, std::uint32_t per_ray, const py::iterable& want) {
    HitArrays out(want, lists.rays.count * per_ray);
    auto counts = make<std::uint32_t>({static_cast<py::ssize_t>(lists.rays.count)});
    std::uint32_t* data = counts.mutable_data();
    mdk_status status;
    {
      const py::gil_scoped_release release;
      status = mdk_all_hits(model_, &lists.rays, per_ray, &out.hits, data);
    }
    check(status);
    return py::make_tuple(counts, out.arrays);
  }
  py::dict closest_points(std::size_t count, const Floats& points, const Floats& radii,
                          const Doubles& times, std::uint32_t clip, mdk_wrap wrap,
                          std::uint32_t threads, const py::iterable& want) {
    mdk_points list;
    mdk_points_init(&list, count, points.data());
    list.radii = radii.data();
    list.times = times.data();
    list.point_stride = stride_of(points, 1);
    list.radius_stride = stride_of(radii, 0);
    list.time_stride = stride_of(times, 0);
    list.clip = clip;
    list.wrap = wrap;
    list.threads = threads;
    HitArrays out(want, count);
    mdk_status status;
    {
      const py::gil_scoped_release release;
      status = mdk_closest_points(model_, &list, &out.hits);
    }
    check(status);
    return out.arrays;
  }

 private:
  static py::array bounds(const float (&low)[3], const float (&high)[3]) {
    auto box = make<float>({2, 3});
    std::copy(low, low + 3, box.mutable_data());
    std::copy(high, high + 3, box.mutable_data() + 3);
    return box;
  }
  py::ssize_t count(std::uint32_t mdk_model_info::*member) const {
    mdk_model_info info;
    mdk_model_info_init(&info);
    check(mdk_model_get_info(model_, &info));
    return static_cast<py::ssize_t>(info.*member);
  }

  mdk_model* model_;
};

}  // namespace

PYBIND11_MODULE(_mdk, m) {
  m.attr("version") = mdk_version();
  py::class_<Model::RayLists>(m, "RayLists")
      .def(py::init<std::size_t, Floats, Floats, Floats, Floats, Doubles, std::uint32_t, mdk_wrap,
                    std::uint32_t>());
  py::class_<Model>(m, "Model")
      .def_static("load", &Model::load)
      .def_static("bake", &Model::bake)
      .def("save", &Model::save)
      .def("info", &Model::info)
      .def("clip", &Model::clip)
      .def("faces", &Model::faces)
      .def("source_triangles", &Model::source_triangles)
      .def("material_colors", &Model::material_colors)
      .def("vertices", &Model::vertices)
      .def("prepare", &Model::prepare)
      .def("ray_bytes", &Model::ray_bytes)
      .def("cast", &Model::cast)
      .def("occluded", &Model::occluded)
      .def("all_hits", &Model::all_hits)
      .def("closest_points", &Model::closest_points);
}
