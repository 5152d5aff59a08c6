// Decode each mesh once, list who shows it, sample bones and morph weights at every key of every
// clip, join the vertices that are computed from the same numbers, and decode the poses.
#include "formats/gltf/reader.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <new>
#include <tuple>
#include <utility>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "formats/files/notes.h"
#include "formats/gltf/animation.h"
#include "formats/gltf/document.h"
#include "formats/gltf/geometry.h"
#include "formats/gltf/images.h"
#include "formats/gltf/pose.h"

namespace mdk {
namespace {

using namespace gltf;

constexpr std::size_t kMaxVertices = std::size_t{1} << 27;
constexpr std::size_t kMaxCorners = std::size_t{1} << 29;
constexpr std::size_t kMaxLinks = 0xffffffffu;
constexpr std::uint32_t kWhite = 0xffffffffu;
constexpr std::size_t kKeysPerChunk = 2;
constexpr std::size_t kKeysPerReport = 32;

std::string mebibytes(std::size_t bytes) { return std::to_string(bytes >> 20) + " MiB"; }

Error too_large(const std::string& path, const std::string& what) {
  return {ErrorCode::kOverLimit, path + ": shows " + what + " in all, more than can be held"};
}

/// What the visible nodes unfold to, before anything is decoded: nodes may share meshes, and meshes
/// accessors, so that a small file can ask for a lot.
void check_extent(const Document& document, const ReadOptions& options) {
  const std::size_t max_vertices = std::min(kMaxVertices, options.most_pose_bytes / sizeof(Vec3f));
  std::size_t vertices = 0, corners = 0;
  for (int n : document.visible_nodes) {
    const int mesh = entry(document.nodes, n).mesh;
    for (const Primitive& p : entry(document.meshes, mesh).primitives) {
      if (p.positions == kNone) continue;
      const std::size_t v = entry(document.accessors, p.positions).count;
      const std::size_t i = p.indices == kNone ? v : entry(document.accessors, p.indices).count;
      vertices += v;
      corners += p.mode == PrimitiveMode::kTriangles ? i : 3 * i;
      if (vertices > max_vertices)
        throw too_large(document.path,
                        "over " + std::to_string(max_vertices / 1'000'000) + " million vertices");
      if (corners > kMaxCorners) throw too_large(document.path, "over 178 million triangles");
    }
  }
}

/// Everything that is shown: instances and the geometry they point at.
struct Scene {
  std::map<int, MeshGeometry> meshes;
  std::vector<SkinBinding> skins;
  std::vector<Instance> instances;
};

Scene read_scene(const Document& document, const ReadOptions& options,
                 std::vector<std::string>& notes) {
  check_extent(document, options);
  Scene scene;
  scene.skins = read_skins(document);
  for (int n : document.visible_nodes) {
    const Node& node = entry(document.nodes, n);
    if (!scene.meshes.contains(node.mesh))
      scene.meshes.emplace(node.mesh, read_mesh(document, node.mesh, notes));
    for (const PrimitiveGeometry& geometry : scene.meshes.at(node.mesh).primitives) {
      Instance instance{&geometry, n, geometry.first_influence.empty() ? kNone : node.skin};
      if (instance.skin != kNone &&
          geometry.joint_count > entry(scene.skins, node.skin).joints.size())
        throw bad_input(document.path, "mesh " + std::to_string(node.mesh) + " refers to joint " +
                                           std::to_string(geometry.joint_count - 1) +
                                           ", which skin " + std::to_string(node.skin) +
                                           " does not have");
      scene.instances.push_back(instance);
    }
  }
  if (scene.instances.empty())
    throw bad_input(document.path, "shows no triangles in its default scene");
  return scene;
}

/// Joint maps of one instance; none without a skin.
std::vector<Affine3d> joints_of(const Scene& scene, const Instance& instance,
                                const NodePose& pose) {
  if (instance.skin == kNone) return {};
  return pose_joints(entry(scene.skins, instance.skin), pose);
}

/// Gathers an appearance, primitive by primitive, in triangle order.
class AppearanceBuilder {
 public:
  /// Keeps references to both; image files, read or unread, and notes are added to `result`.
  AppearanceBuilder(const Document& document, ReadResult& result)
      : document_(document), result_(result) {}

  /// Adds `triangles` of `geometry` (its own vertex numbers, as wound in the result). An image that
  /// is missing or broken becomes a note and the plain base colour.
  void add(const PrimitiveGeometry& geometry, std::span<const Triangle> triangles);

  /// What was gathered; the builder is empty afterwards.
  Appearance take();

 private:
  std::uint32_t material_for(const PrimitiveGeometry& geometry);
  std::uint32_t texture_for(int image);
  std::uint32_t load_texture(int image);

  const Document& document_;
  ReadResult& result_;
  Appearance appearance_;
  std::map<std::tuple<int, bool, bool>, std::uint32_t> materials_;  ///< source, normals, texcoords
  std::map<int, std::uint32_t> textures_;                           ///< by image
};

void AppearanceBuilder::add(const PrimitiveGeometry& geometry,
                            std::span<const Triangle> triangles) {
  const std::size_t corners_before = 3 * appearance_.triangle_materials.size();
  const std::size_t corners_after = corners_before + 3 * triangles.size();
  appearance_.triangle_materials.resize(corners_after / 3, material_for(geometry));
  // The first primitive with such data starts the list; corners before and after it get a default.
  if (!geometry.texcoords.empty() || !appearance_.corner_texcoords.empty())
    appearance_.corner_texcoords.resize(corners_after);
  if (!geometry.colors.empty() || !appearance_.corner_colors.empty())
    appearance_.corner_colors.resize(corners_after, kWhite);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t corner = corners_before + 3 * t + c;
      const std::uint32_t v = triangles[t].v[c];
      if (!geometry.texcoords.empty()) appearance_.corner_texcoords[corner] = geometry.texcoords[v];
      if (!geometry.colors.empty()) appearance_.corner_colors[corner] = geometry.colors[v];
    }
  }
}

Appearance AppearanceBuilder::take() {
  if (appearance_.materials.empty()) appearance_.materials.push_back({});
  return std::exchange(appearance_, {});
}

std::uint32_t AppearanceBuilder::material_for(const PrimitiveGeometry& geometry) {
  const auto key = std::tuple(geometry.material, geometry.has_normals, !geometry.texcoords.empty());
  const auto known = materials_.find(key);
  if (known != materials_.end()) return known->second;

  Material material;
  std::ranges::fill(material.base_color, 1.0f);  // glTF's default, where no material is named
  if (geometry.material != kNone) {
    const MaterialSource& source = entry(document_.materials, geometry.material);
    material = source.material;
    if (!geometry.texcoords.empty()) material.texture = texture_for(source.image);
  }
  if (!geometry.has_normals) material.flags |= kMaterialFlatShaded;
  const auto number = static_cast<std::uint32_t>(appearance_.materials.size());
  appearance_.materials.push_back(material);
  return materials_[key] = number;
}

std::uint32_t AppearanceBuilder::texture_for(int image) {
  const auto known = textures_.find(image);
  if (known != textures_.end()) return known->second;
  return textures_[image] = load_texture(image);
}

std::uint32_t AppearanceBuilder::load_texture(int image) {
  const ImageSource& source = entry(document_.images, image);
  const auto leave_out = [&](const std::string& why) {
    add_note(result_.notes,
             "image " + std::to_string(image) + " " + why + "; the plain base colour is shown");
    return kNoTexture;
  };
  Bytes file;
  std::span<const unsigned char> bytes = source.bytes;
  if (bytes.empty()) {
    std::string path;
    try {
      path = resolve_uri(document_.path, source.uri);
      file = read_whole_file(path);
    } catch (const Error&) {
      if (!path.empty()) result_.unread.push_back(path);
      return leave_out("(\"" + source.uri.substr(0, 200) + "\") cannot be read");
    }
    result_.dependencies.push_back(path);
    bytes = file;
  }
  std::string problem;
  const std::uint32_t number = add_texture(bytes, appearance_, problem);
  if (number == kNoTexture) return leave_out(problem);
  return number;
}

/// Triangles, appearance and smoothing groups; mirrored instances are turned inside out again.
std::vector<std::uint64_t> assemble(const Document& document, const Scene& scene,
                                    const NodePose& pose, ReadResult& result) {
  PoseSequence& sequence = result.sequence;
  AppearanceBuilder appearance(document, result);
  std::vector<std::uint64_t> groups;
  std::uint32_t mesh = 0;  // primitives of one node follow each other and are one mesh
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    if (i > 0 && instance.node != scene.instances[i - 1].node) ++mesh;
    const PrimitiveGeometry& geometry = *instance.geometry;
    std::vector<Triangle> triangles = geometry.triangles;
    if (is_mirrored(instance, pose, joints_of(scene, instance, pose)))
      for (Triangle& t : triangles) std::swap(t.v[1], t.v[2]);
    appearance.add(geometry, triangles);
    for (const Triangle& t : triangles)
      sequence.triangles.push_back({{t.v[0] + sequence.vertex_count, t.v[1] + sequence.vertex_count,
                                     t.v[2] + sequence.vertex_count}});
    sequence.triangle_meshes.resize(sequence.triangles.size(), mesh);
    groups.insert(groups.end(), geometry.smoothing_groups.begin(), geometry.smoothing_groups.end());
    sequence.vertex_count += static_cast<std::uint32_t>(geometry.positions.size());
  }
  sequence.appearance = appearance.take();
  return groups;
}

/// Lists the clips' keys in the sequence.
void lay_out_keys(const Document& document, const std::vector<AnimationClip>& clips,
                  const RigPlan& plan, std::size_t max_bytes, PoseSequence& sequence) {
  for (const AnimationClip& clip : clips) {
    sequence.clips.push_back(
        {clip.name, sequence.key_count(), static_cast<std::uint32_t>(clip.key_times.size())});
    sequence.key_times.insert(sequence.key_times.end(), clip.key_times.begin(),
                              clip.key_times.end());
  }
  const std::size_t bytes_per_key = sizeof(Vec3f) * sequence.vertex_count + plan.bytes_per_key();
  if (sequence.key_times.size() > max_bytes / bytes_per_key)
    throw Error(ErrorCode::kOverLimit,
                document.path + ": " + std::to_string(sequence.key_times.size()) + " keys of " +
                    std::to_string(sequence.vertex_count) + " vertices take over " +
                    mebibytes(max_bytes) + "; choose a lower --fps or fewer --clips");
}

void sample_keys(const Document& document, const RigPlan& plan,
                 const std::vector<AnimationClip>& clips, PoseSequence& sequence,
                 ProgressSink& progress) {
  plan.make_room(*sequence.rig, sequence.key_count());
  for (std::size_t c = 0; c < clips.size(); ++c) {
    const Clip& keys = sequence.clips[c];
    for (std::size_t begin = 0; begin < keys.key_count; begin += kKeysPerReport) {
      progress.report("read", static_cast<double>(keys.first_key + begin) / sequence.key_count());
      const std::size_t count = std::min<std::size_t>(kKeysPerReport, keys.key_count - begin);
      parallel_chunks(count, kKeysPerChunk, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = begin + from; i < begin + to; ++i)
          plan.set_key(*sequence.rig, keys.first_key + i,
                       pose_nodes(document, clips[c], clips[c].key_times[i]));
      });
    }
  }
}

void simplify(const Document& document, const RigPlan& plan, const ReadOptions& options,
              PoseSequence& sequence) {
  const std::vector<std::uint32_t> kept =
      simplify_rig(*sequence.rig, sequence.key_count(),
                   options.skeleton ? AlikeBones::kKeep : AlikeBones::kJoin);
  if (!options.skeleton) return;
  Skeleton all = plan.skeleton(document);
  std::vector<BoneBinding> bones;
  for (const std::uint32_t bone : kept) bones.push_back(all.bones[bone]);
  all.bones = std::move(bones);
  sequence.skeleton = std::move(all);
}

bool is_finite(std::span<const Vec3f> positions) {
  bool finite = true;
  for (const Vec3f& p : positions)
    finite &= std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  return finite;
}

void check_finite(const Document& document, const PoseSequence& sequence) {
  std::vector<char> fails(sequence.key_count(), 0);
  parallel_chunks(fails.size(), kKeysPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t key = begin; key < end; ++key)
      fails[key] = !is_finite(sequence.pose(static_cast<std::uint32_t>(key)));
  });
  for (const Clip& clip : sequence.clips)
    for (std::size_t key = clip.first_key; key < clip.first_key + clip.key_count; ++key)
      if (fails[key])
        throw bad_input(document.path, "clip \"" + clip.name +
                                           "\" takes a vertex out of range at " +
                                           std::to_string(sequence.key_times[key]) + " s");
}

Error no_memory(const std::string& path) {
  return {ErrorCode::kOverLimit,
          path + ": does not fit into memory; choose a lower --fps or fewer --clips"};
}

void check_rate(const ReadOptions& options) {
  if (!(options.fps > 0 && options.fps <= 10000))
    throw Error(ErrorCode::kUsage, "--fps must be above 0 and at most 10000");
}

/// Everything but the bytes, which stand at `path`.
void unfold(const std::string& path, const Bytes& bytes, const ReadOptions& options,
            ProgressSink& progress, ReadResult& result) {
  const Document document = parse_document(path, bytes, result);
  const std::vector<AnimationClip> clips = read_clips(document, options);
  const Scene scene = read_scene(document, options, result.notes);

  PoseSequence& sequence = result.sequence;
  sequence.positions = PositionList(options.scratch);
  const NodePose first_pose = pose_nodes(document, clips[0], 0.0);
  const std::vector<std::uint64_t> groups = assemble(document, scene, first_pose, result);
  const RigPlan plan(scene.instances, scene.skins);
  if (plan.max_links() > kMaxLinks)
    throw too_large(document.path, "over 4 billion joint weights or morph offsets");
  lay_out_keys(document, clips, plan, options.most_pose_bytes, sequence);
  sequence.rig = plan.shape();
  sample_keys(document, plan, clips, sequence, progress);
  simplify(document, plan, options, sequence);
  weld_vertices(sequence, groups);
  decode_positions(sequence);
  check_finite(document, sequence);
  check_consistency(sequence);
  progress.report("read", 1.0);
}

}  // namespace

ReadResult read_gltf(const std::string& path, const ReadOptions& options, ProgressSink& progress) {
  check_rate(options);
  progress.report("read", 0.0);
  try {
    ReadResult result;
    const Bytes bytes = read_whole_file(path);
    result.dependencies.push_back(path);
    unfold(path, bytes, options, progress, result);
    return result;
  } catch (const std::bad_alloc&) {
    throw no_memory(path);
  }
}

ReadResult read_glb(const std::string& path, const Bytes& bytes, const ReadOptions& options,
                    ProgressSink& progress) {
  check_rate(options);
  try {
    ReadResult result;
    unfold(path, bytes, options, progress, result);
    return result;
  } catch (const std::bad_alloc&) {
    throw no_memory(path);
  }
}

}  // namespace mdk
