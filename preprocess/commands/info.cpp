// mdprep info: what is inside a .mdk file, as a table or as JSON.
#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "common/base/parallel.h"
#include "common/base/text.h"
#include "formats/mdk/mdk_file.h"
#include "preprocess/boxes/cost.h"
#include "preprocess/commands/command_line.h"
#include "preprocess/tool/measures.h"
#include "preprocess/tool/shared_options.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

bool is_foreign(const MdkOrigin& origin) { return origin.reader == SourceReader::kAssimp; }

using Json = nlohmann::ordered_json;

struct InfoArguments {
  std::string input;
  bool json = false;
  bool areas = false;
  MachineOptions machine;
};

struct ClusterSizes {
  std::uint32_t smallest = 0, largest = 0;
};

ClusterSizes cluster_sizes(const ModelView& model) {
  ClusterSizes sizes{model.triangle_count(), 0};
  for (const Cluster& cluster : model.clusters) {
    sizes.smallest = std::min(sizes.smallest, cluster.triangle_count);
    sizes.largest = std::max(sizes.largest, cluster.triangle_count);
  }
  return sizes;
}

/// How loose the fuzzy boxes of a model are: their area in the world beside that of tight ones.
/// Sums over all triangles in units of the area of the mesh's box at the same key; medians over
/// keys. 0 for a mesh without extent.
struct BoxAreas {
  double fuzzy = 0;  ///< of the fuzzy boxes that hold at the key, mapped back into the world
  double tight = 0;  ///< of the boxes of the triangles as they stand at the key: the floor
};

/// Area of all fuzzy boxes of one key's segment, in the world.
double fuzzy_area_at(const ModelView& model, std::uint32_t key) {
  const std::uint32_t segment = segment_of(model, at_key(key));
  const auto maps = model.key_maps(key);
  double sum = 0;
  for (std::size_t c = 0; c < model.clusters.size(); ++c) {
    FaceSums sums;
    for (const Aabb& box : model.cluster_fuzzy_boxes(segment, c)) sums.add(box);
    sum += sums.area(world_area_weights(to_double(maps[c])));
  }
  return sum;
}

struct KeyAreas {
  double tight = 0, whole = 0;
};

KeyAreas tight_area_at(const ModelView& model, std::uint32_t key) {
  std::vector<Vec3f> pose(model.vertex_count);
  decode_pose(model, key, {0, model.vertex_count}, pose);
  KeyAreas areas;
  Aabb whole;
  for (const Triangle& triangle : model.triangles) {
    Aabb box;
    for (const std::uint32_t v : triangle.v) box.extend(pose[v]);
    areas.tight += static_cast<double>(surface_area(box));
    whole.extend(box);
  }
  areas.whole = static_cast<double>(surface_area(whole));
  return areas;
}

/// Cost: O(keys * triangles).
BoxAreas measure_box_areas(const ModelView& model) {
  const std::size_t keys = model.key_count();
  std::vector<double> fuzzy(keys), tight(keys);
  parallel_chunks(keys, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto key = static_cast<std::uint32_t>(i);
      const KeyAreas areas = tight_area_at(model, key);
      if (!(areas.whole > 0)) continue;
      fuzzy[i] = fuzzy_area_at(model, key) / areas.whole;
      tight[i] = areas.tight / areas.whole;
    }
  });
  return {median(fuzzy), median(tight)};
}

Json json_of(const Vec3f& v) { return Json::array({v.x, v.y, v.z}); }

Json json_of_clips(const ModelView& model) {
  Json clips = Json::array();
  for (const Clip& clip : model.clips)
    clips.push_back({{"name", clip.name},
                     {"seconds", model.clip_seconds(clip)},
                     {"first_key", clip.first_key},
                     {"keys", clip.key_count}});
  return clips;
}

Json json_of_segments(const ModelView& model) {
  Json segments = Json::array();
  for (const Segment& segment : model.segments)
    segments.push_back({{"first_key", segment.first_key}, {"last_key", segment.last_key}});
  return segments;
}

std::string_view pose_kind_name(PoseKind kind) {
  if (kind == PoseKind::kRig) return "rig";
  return kind == PoseKind::kQuantized ? "quantized" : "key_positions";
}

std::string poses_text(const ModelView& model) {
  const PoseSource& poses = model.poses;
  const std::uint32_t keys = model.key_count();
  if (poses.kind == PoseKind::kRig)
    return "a rig of " + grouped_text(poses.rig.bone_maps.size() / keys) + " bones and " +
           grouped_text(poses.rig.target_weights.size() / keys) + " morph targets";
  if (poses.kind == PoseKind::kKeyPositions) return "positions at every key";
  const QuantizationError& error = poses.quantized.error.front();
  return "quantised, off by " + fixed_text(error.largest * 100, 5) + " % of the diagonal (bound " +
         fixed_text(error.bound * 100, 5) + " %)";
}

Json json_of_poses(const PoseSource& poses) {
  Json json = {{"kind", pose_kind_name(poses.kind)}};
  if (poses.kind == PoseKind::kQuantized) {
    json["error_bound"] = poses.quantized.error.front().bound;
    json["largest_error"] = poses.quantized.error.front().largest;
  }
  return json;
}

void print_json(const MdkFile& file, const InfoArguments& arguments) {
  const ModelView& model = file.model();
  Json textures = Json::array();
  for (const Texture& texture : model.appearance.textures)
    textures.push_back({{"width", texture.width}, {"height", texture.height}});
  Json sections = Json::array();
  for (const SectionInfo& section : file.sections())
    sections.push_back({{"name", section.name}, {"bytes", section.bytes}});
  const ClusterSizes sizes = cluster_sizes(model);
  Json info = {
      {"schema", "mdprep-info/1"},
      {"file", file.path()},
      {"file_bytes", file.file_bytes()},
      {"made_by", version_text(file.origin().version)},
      {"options_hash", hash_text(file.origin().options_hash)},
      {"read_through", is_foreign(file.origin()) ? Json("Assimp") : Json(nullptr)},
      {"triangles", model.triangle_count()},
      {"vertices", model.vertex_count},
      {"keys", model.key_count()},
      {"clips", json_of_clips(model)},
      {"segments", json_of_segments(model)},
      {"between_keys", model.holds_between_keys},
      {"clusters", model.cluster_count()},
      {"smallest_cluster_triangles", sizes.smallest},
      {"largest_cluster_triangles", sizes.largest},
      {"kd_nodes", model.kd_nodes.size()},
      {"kd_refs", model.kd_refs.size()},
      {"poses", json_of_poses(model.poses)},
      {"rest_key", model.rest_key},
      {"rest_diagonal", model.rest_diagonal},
      {"bounds", {{"lo", json_of(model.bounds.lo)}, {"hi", json_of(model.bounds.hi)}}},
      {"materials", model.appearance.materials.size()},
      {"textures", textures},
      {"sections", sections},
  };
  if (arguments.areas) {
    const BoxAreas areas = measure_box_areas(model);
    info["fuzzy_area"] = areas.fuzzy;
    info["tight_area"] = areas.tight;
  }
  std::cout << info.dump(2, ' ', false, Json::error_handler_t::replace) << "\n";
}

std::string point_text(const Vec3f& v) {
  return "(" + fixed_text(v.x, 4) + ", " + fixed_text(v.y, 4) + ", " + fixed_text(v.z, 4) + ")";
}

std::string textures_text(const ModelView& model) {
  std::string text = std::to_string(model.appearance.textures.size());
  for (const Texture& texture : model.appearance.textures)
    text += (text.find(' ') == std::string::npos ? " (" : ", ") + std::to_string(texture.width) +
            "x" + std::to_string(texture.height);
  return model.appearance.textures.empty() ? text : text + ")";
}

std::string origin_text(const MdkOrigin& origin) {
  if (origin == MdkOrigin{}) return "not known";
  return "mdprep " + version_text(origin.version) + ", options " + hash_text(origin.options_hash) +
         (is_foreign(origin) ? ", source read through Assimp" : "");
}

/// How many, and the keys of the first few.
std::string segments_text(const ModelView& model) {
  constexpr std::uint32_t kShown = 8;
  std::string text = grouped_text(model.segment_count()) + " (keys";
  for (std::uint32_t s = 0; s < std::min(kShown, model.segment_count()); ++s)
    text += (s == 0 ? " " : ", ") + std::to_string(model.segments[s].first_key) + "-" +
            std::to_string(model.segments[s].last_key);
  return text + (model.segment_count() > kShown ? ", ...)" : ")");
}

void print_facts(const MdkFile& file, const InfoArguments& arguments) {
  const ModelView& model = file.model();
  const ClusterSizes sizes = cluster_sizes(model);
  const Clip& rest_clip = model.clips[clip_of_key(model, model.rest_key)];
  TextTable facts(2);
  facts.add_row({"file", file.path() + " (" + bytes_text(file.file_bytes()) + ")"});
  facts.add_row({"made by", origin_text(file.origin())});
  facts.add_row({"triangles", grouped_text(model.triangle_count())});
  facts.add_row({"vertices", grouped_text(model.vertex_count)});
  facts.add_row({"keys", grouped_text(model.key_count())});
  facts.add_row({"poses", poses_text(model)});
  facts.add_row({"clusters", grouped_text(model.cluster_count()) + " (of " +
                                 grouped_text(sizes.smallest) + " to " +
                                 grouped_text(sizes.largest) + " triangles)"});
  facts.add_row({"time segments", segments_text(model)});
  facts.add_row({"boxes hold", model.holds_between_keys
                                   ? "at every time"
                                   : "at keys only: a time between keys is shown as the nearest"});
  facts.add_row({"fuzzy kd-trees", grouped_text(model.kd_nodes.size()) + " nodes, " +
                                       grouped_text(model.kd_refs.size()) + " references"});
  facts.add_row({"rest pose", "key " + std::to_string(model.rest_key) + " (" +
                                  printable_line(rest_clip.name) + " at " +
                                  fixed_text(model.key_times[model.rest_key], 3) +
                                  " s), diagonal " + fixed_text(model.rest_diagonal, 4)});
  facts.add_row({"bounds", point_text(model.bounds.lo) + " to " + point_text(model.bounds.hi)});
  facts.add_row({"materials", std::to_string(model.appearance.materials.size())});
  facts.add_row({"textures", textures_text(model)});
  if (arguments.areas) {
    const BoxAreas areas = measure_box_areas(model);
    facts.add_row({"fuzzy boxes", fixed_text(areas.fuzzy, 2) + " areas of the mesh's box, " +
                                      fixed_text(areas.tight, 2) + " if they were tight"});
  }
  facts.print(std::cout);
}

void print_tables(const MdkFile& file) {
  const ModelView& model = file.model();
  TextTable clips(1);
  clips.add_row({"clip", "seconds", "keys", "first key", "last key"});
  for (const Clip& clip : model.clips)
    clips.add_row({printable_line(clip.name), fixed_text(model.clip_seconds(clip), 3),
                   std::to_string(clip.key_count), std::to_string(clip.first_key),
                   std::to_string(clip.first_key + clip.key_count - 1)});
  TextTable sections(1);
  sections.add_row({"section", "bytes"});
  for (const SectionInfo& section : file.sections())
    sections.add_row({section.name, grouped_text(section.bytes)});
  std::cout << "\n";
  clips.print(std::cout);
  std::cout << "\n";
  sections.print(std::cout);
}

void run_info(const InfoArguments& arguments) {
  const MachineLimits limits(arguments.machine);
  const MdkFile file(arguments.input);
  if (arguments.json) {
    print_json(file, arguments);
  } else {
    print_facts(file, arguments);
    print_tables(file);
  }
}

}  // namespace

void add_info_command(Command& command) {
  const auto arguments = std::make_shared<InfoArguments>();
  command.add_text("FILE", "", "A .mdk file made by 'mdprep bake'.", arguments->input).required();
  command.add_flag("--json", "Print JSON (mdprep-info/1) instead of tables.", arguments->json);
  command.add_flag(
      "--areas",
      "Also measure how loose the fuzzy boxes are: their area in the world, summed, in\n"
      "areas of the mesh's box, and that of the triangles' own boxes; medians over keys.",
      arguments->areas);
  add_machine_options(command, arguments->machine);
  command.set_notes(
      "Example:\n"
      "  mdprep info hand.mdk\n"
      "  mdprep info hand.mdk --json --areas");
  command.set_body([arguments](CommandContext&) { run_info(*arguments); });
}

}  // namespace mdk
