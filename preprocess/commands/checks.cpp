#include "preprocess/commands/checks.h"

#include <algorithm>
#include <cstdio>
#include <random>

#include "common/base/parallel.h"
#include "common/math/affine3.h"
#include "common/motion/posed_mesh.h"
#include "common/trace/renderer.h"
#include "preprocess/tool/shared_options.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

constexpr std::size_t kTrianglesPerChunk = 8192;

std::vector<std::uint32_t> triangle_clusters(const ModelView& model) {
  std::vector<std::uint32_t> owner(model.triangle_count());
  for (std::uint32_t c = 0; c < model.cluster_count(); ++c) {
    const Cluster& cluster = model.clusters[c];
    std::fill_n(owner.begin() + cluster.first_triangle, cluster.triangle_count, c);
  }
  return owner;
}

std::string moment_text(const ModelView& model, const KeyInterval& at) {
  const std::string key = "key " + std::to_string(at.key0);
  const std::string clip = " of clip " + model.clips[clip_of_key(model, at.key0)].name;
  return (at.key0 == at.key1 ? key : key + " + " + fixed_text(at.s, 6)) + clip;
}

Aabbd to_double(const Aabb& box) { return {mdk::to_double(box.lo), mdk::to_double(box.hi)}; }

/// Failures of one kind at one moment: how many, and the first triangle.
struct Failures {
  std::uint64_t count = 0;
  std::uint32_t first = 0;

  void add(std::uint32_t triangle) {
    if (count++ == 0) first = triangle;
  }
  void add(const Failures& later) {
    if (count == 0) first = later.first;
    count += later.count;
  }
};

struct BoxFailures {
  Failures fuzzy, world, bounds;

  void add(const BoxFailures& later) {
    fuzzy.add(later.fuzzy);
    world.add(later.world);
    bounds.add(later.bounds);
  }
};

/// What holds at one moment for all triangles.
class MomentCheck {
 public:
  explicit MomentCheck(const ModelView& model)
      : model_(model), mesh_(model), owner_(triangle_clusters(model)) {}

  /// At a key that two segments share, the boxes of both must hold.
  BoxFailures check(const KeyInterval& at) {
    const std::uint32_t segment = segment_of(model_, at);
    BoxFailures failures = check(at, segment);
    if (segment + 1 < model_.segment_count() && model_.segments[segment + 1].first_key == at.key0) {
      failures.fuzzy.add(check(at, segment + 1).fuzzy);
    }
    return failures;
  }

 private:
  BoxFailures check(const KeyInterval& at, std::uint32_t segment) {
    mesh_.set_time(at);
    segment_ = segment;
    maps_.resize(model_.cluster_count());
    world_boxes_.resize(model_.cluster_count());
    for (std::uint32_t c = 0; c < model_.cluster_count(); ++c) {
      maps_[c] = interpolate(model_.key_maps(at.key0)[c], model_.key_maps(at.key1)[c], at.s);
      world_boxes_[c] = cluster_world_box(model_, c, at);
    }
    const std::size_t chunks = (owner_.size() + kTrianglesPerChunk - 1) / kTrianglesPerChunk;
    std::vector<BoxFailures> found(chunks);
    parallel_chunks(owner_.size(), kTrianglesPerChunk, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t)
        check_triangle(static_cast<std::uint32_t>(t), found[begin / kTrianglesPerChunk]);
    });
    BoxFailures all;
    for (const BoxFailures& chunk : found) all.add(chunk);
    return all;
  }

  void check_triangle(std::uint32_t t, BoxFailures& failures) const {
    const std::uint32_t c = owner_[t];
    const Aabbd fuzzy_box = to_double(model_.fuzzy_box(segment_, c, t));
    bool in_fuzzy = true, in_world = true, in_bounds = true;
    for (const std::uint32_t v : model_.triangles[t].v) {
      const Vec3f& position = mesh_.positions()[v];
      in_fuzzy = in_fuzzy && fuzzy_box.contains(maps_[c].point(mdk::to_double(position)));
      in_world = in_world && world_boxes_[c].contains(position);
      in_bounds = in_bounds && model_.bounds.contains(position);
    }
    if (!in_fuzzy) failures.fuzzy.add(t);
    if (!in_world) failures.world.add(t);
    if (!in_bounds) failures.bounds.add(t);
  }

  const ModelView& model_;
  PosedMesh mesh_;
  std::vector<std::uint32_t> owner_;
  std::uint32_t segment_ = 0;
  std::vector<Affine3d> maps_;
  std::vector<Aabb> world_boxes_;
};

void record(CheckResult& result, std::uint64_t looked_at, const Failures& failures,
            const std::string& moment) {
  if (result.passed() && failures.count > 0)
    result.detail = "first: triangle " + std::to_string(failures.first) + " at " + moment;
  result.count += looked_at;
  result.failures += failures.count;
}

/// Whether every leaf below a node that one triangle's box reaches into lists the triangle; counts
/// the leaves that were looked at. A box that lies flat in a split plane belongs to either side: a
/// ray that crosses the plane there visits both.
bool is_listed(const KdTreeView& tree, std::uint32_t node_index, const Aabb& box,
               std::uint32_t triangle, std::uint64_t& leaves) {
  const KdNode& node = tree.nodes[node_index];
  if (node.is_leaf()) {
    const auto refs = tree.refs.subspan(node.first_ref(), node.ref_count());
    ++leaves;
    return std::find(refs.begin(), refs.end(), triangle) != refs.end();
  }
  const auto is_listed_in = [&](std::uint32_t child) {
    return is_listed(tree, child, box, triangle, leaves);
  };
  const float lo = box.lo[node.axis()], hi = box.hi[node.axis()], split = node.split();
  if (lo == split && hi == split) return is_listed_in(node.below()) || is_listed_in(node.above());
  return (lo >= split || is_listed_in(node.below())) && (hi <= split || is_listed_in(node.above()));
}

void check_tree(const ModelView& model, std::size_t tree_index, CheckResult& leaves) {
  const std::size_t c = tree_index % model.clusters.size();
  const Cluster& cluster = model.clusters[c];
  const auto segment = static_cast<std::uint32_t>(tree_index / model.clusters.size());
  const KdTreeView tree = model.tree_view(model.fuzzy_trees[tree_index]);
  for (std::uint32_t i = 0; i < cluster.triangle_count; ++i) {
    const std::uint32_t t = cluster.first_triangle + i;
    Failures unlisted;
    std::uint64_t visited = 0;
    if (!is_listed(tree, 0, model.fuzzy_box(segment, c, t), t, visited)) unlisted.add(t);
    record(leaves, visited, unlisted, "any time of segment " + std::to_string(segment));
  }
}

std::vector<Camera> cameras_for(const ModelView& model) {
  const double size = diagonal(model.bounds) > 0 ? diagonal(model.bounds) : 1;
  const Vec3d center = to_double(model.bounds.center());
  Camera close;
  close.target = to_float(center);
  close.eye = to_float(center + Vec3d{-0.30, -0.25, -0.60} * size);
  close.vertical_fov_deg = 35;
  Camera inside;
  inside.eye = to_float(center + Vec3d{0.01, 0.02, 0.03} * size);
  inside.target = to_float(center + Vec3d{0.7, -0.4, 0.2} * size);
  inside.vertical_fov_deg = 100;
  return {fit_camera(model.bounds, 1), close, inside};
}

struct JudgedTechnique {
  Renderer renderer;
  CheckResult result;

  JudgedTechnique(const ModelView& model, std::string_view id)
      : renderer(model, id), result{std::string(id) + " gives brute force's hits", 0, 0, ""} {}

  void judge(const FrameRequest& request, const HitBuffer& truth) {
    renderer.trace(request);
    const std::uint64_t mismatches = count_mismatches(renderer.hits(), truth);
    if (result.passed() && mismatches > 0)
      result.detail =
          "first: key " + std::to_string(request.at.key0) + " + " + fixed_text(request.at.s, 6);
    result.count += static_cast<std::uint64_t>(request.width) * request.height;
    result.failures += mismatches;
  }
};

CheckResult check_shape(const ModelView& model, const PoseSequence& source) {
  CheckResult shape{"the source has the same triangles, clips and key times", 0, 0, ""};
  const auto compare = [&](bool same, const std::string& difference) {
    ++shape.count;
    if (same) return;
    if (shape.passed()) shape.detail = difference;
    ++shape.failures;
  };
  compare(model.triangle_count() == source.triangles.size(),
          "the source has " + std::to_string(source.triangles.size()) + " triangles, the file " +
              std::to_string(model.triangle_count()));
  compare(
      std::equal(model.clips.begin(), model.clips.end(), source.clips.begin(), source.clips.end()),
      "the clips differ: give the --clips and --fps of the bake");
  compare(std::equal(model.key_times.begin(), model.key_times.end(), source.key_times.begin(),
                     source.key_times.end()),
          "the key times differ: give the --fps of the bake");
  return shape;
}

}  // namespace

std::uint64_t interval_count(const ModelView& model) {
  std::uint64_t count = 0;
  for (const Clip& clip : model.clips) count += clip.key_count - 1;
  return count;
}

std::vector<KeyInterval> random_moments(const ModelView& model, std::uint32_t count,
                                        std::uint64_t seed) {
  std::vector<std::uint32_t> starts;  // the first key of every interval
  for (const Clip& clip : model.clips)
    for (std::uint32_t i = 0; i + 1 < clip.key_count; ++i) starts.push_back(clip.first_key + i);
  std::vector<KeyInterval> moments;
  if (starts.empty()) return moments;
  std::mt19937_64 random(seed);
  for (std::uint32_t i = 0; i < count; ++i) {
    // Not std::uniform_real_distribution, whose numbers differ between libraries.
    const double u = static_cast<double>(random() >> 11) * 0x1p-53;
    const double place = (i + u) / count * static_cast<double>(starts.size());
    const std::size_t interval = std::min(static_cast<std::size_t>(place), starts.size() - 1);
    const float s = static_cast<float>(place - static_cast<double>(interval));
    const std::uint32_t key = starts[interval];
    moments.push_back(s > 0 && s < 1 ? KeyInterval{key, key + 1, s}
                                     : KeyInterval{key, key + 1, 0.5f});
  }
  return moments;
}

std::vector<CheckResult> check_boxes(const ModelView& model, std::span<const KeyInterval> between,
                                     ProgressSink& progress) {
  const std::string when[] = {"at keys", "between keys"};
  std::vector<CheckResult> results;
  MomentCheck moment(model);
  const std::size_t total = model.key_count() + between.size();
  std::size_t done = 0;
  const auto check_all = [&](std::size_t count, const auto& moment_at, const std::string& label) {
    CheckResult fuzzy{"fuzzy boxes hold their triangles " + label, 0, 0, ""};
    CheckResult world{"cluster boxes hold their triangles " + label, 0, 0, ""};
    CheckResult bounds{"bounds hold the mesh " + label, 0, 0, ""};
    for (std::size_t i = 0; i < count; ++i) {
      progress.report("boxes", static_cast<double>(done++) / static_cast<double>(total));
      const KeyInterval at = moment_at(i);
      const BoxFailures failures = moment.check(at);
      const std::string text = moment_text(model, at);
      record(fuzzy, model.triangle_count(), failures.fuzzy, text);
      record(world, model.triangle_count(), failures.world, text);
      record(bounds, model.triangle_count(), failures.bounds, text);
    }
    results.insert(results.end(), {fuzzy, world, bounds});
  };
  check_all(
      model.key_count(), [](std::size_t i) { return at_key(static_cast<std::uint32_t>(i)); },
      when[0]);
  if (model.holds_between_keys)
    check_all(
        between.size(), [&](std::size_t i) { return between[i]; }, when[1]);
  return results;
}

CheckResult check_trees(const ModelView& model, ProgressSink& progress) {
  CheckResult leaves{"leaves list every triangle that reaches into them", 0, 0, ""};
  for (std::size_t i = 0; i < model.fuzzy_trees.size(); ++i) {
    progress.report("trees",
                    static_cast<double>(i) / static_cast<double>(model.fuzzy_trees.size()));
    check_tree(model, i, leaves);
  }
  return leaves;
}

std::vector<CheckResult> check_hits(const ModelView& model, std::span<const KeyInterval> between,
                                    ProgressSink& progress) {
  constexpr std::uint32_t kSide = 128;  // pixels
  constexpr std::uint32_t kKeys = 4;    // spread over all clips
  std::vector<KeyInterval> moments(between.begin(), between.end());
  for (const std::uint32_t key : spread_keys(kKeys, model.key_count()))
    moments.push_back(at_key(key));
  const std::vector<Camera> cameras = cameras_for(model);

  Renderer oracle(model, "brute-force");
  std::vector<std::unique_ptr<JudgedTechnique>> techniques;
  for (const TechniqueInfo& technique : technique_table())
    if (technique.kind != TechniqueKind::kOracle && technique.kind != TechniqueKind::kPeer)
      techniques.push_back(std::make_unique<JudgedTechnique>(model, technique.id));

  FrameRequest request;
  request.width = request.height = kSide;
  for (std::size_t m = 0; m < moments.size(); ++m) {
    request.at = moments[m];
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      progress.report("hits", static_cast<double>(m * cameras.size() + c) /
                                  static_cast<double>(moments.size() * cameras.size()));
      request.camera = cameras[c];
      oracle.trace(request);
      for (const auto& technique : techniques) technique->judge(request, oracle.hits());
    }
  }
  std::vector<CheckResult> results;
  for (const auto& technique : techniques) results.push_back(technique->result);
  return results;
}

std::vector<CheckResult> check_source(const ModelView& model, const PoseSequence& source) {
  const CheckResult shape = check_shape(model, source);
  if (!shape.passed()) return {shape};
  CheckResult positions{"corners stand where the source has them", 0, 0, ""};
  double largest = 0, allowed = 0;
  if (model.poses.kind == PoseKind::kQuantized)
    allowed = model.poses.quantized.error.front().bound * model.rest_diagonal;
  PosedMesh mesh(model);
  for (std::uint32_t key = 0; key < model.key_count(); ++key) {
    mesh.set_time(at_key(key));
    const auto baked = mesh.positions();
    const auto read = source.pose(key);
    for (std::uint32_t t = 0; t < model.triangle_count(); ++t)
      for (int corner = 0; corner < 3; ++corner) {
        const Vec3f& a = baked[model.triangles[t].v[corner]];
        const Vec3f& b = read[source.triangles[model.source_triangles[t]].v[corner]];
        ++positions.count;
        const double distance = length(to_double(a) - to_double(b));
        positions.failures += !(distance <= allowed);
        largest = std::max(largest, distance);
      }
  }
  char text[64];
  std::snprintf(text, sizeof text, "largest error %.3g of the diagonal",
                model.rest_diagonal > 0 ? largest / model.rest_diagonal : largest);
  positions.detail = text;
  return {shape, positions};
}

}  // namespace mdk
