#include "preprocess/cli/hit_checks.h"

#include <string>

#include "common/trace/renderer.h"
#include "preprocess/cli/key_range.h"
#include "preprocess/cli/number_text.h"

namespace mdk {
namespace {

std::vector<Camera> cameras_for(const Model& model) {
  const double size = model.bounds.diagonal() > 0 ? model.bounds.diagonal() : 1;
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

  JudgedTechnique(const Model& model, std::string_view id)
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

}  // namespace

std::vector<CheckResult> check_hits(const Model& model, const HitCheckConfig& config,
                                    std::span<const KeyInterval> between, ProgressSink& progress) {
  std::vector<KeyInterval> moments(between.begin(), between.end());
  for (const std::uint32_t key : spread_keys(config.keys, model.key_count()))
    moments.push_back(at_key(key));
  const std::vector<Camera> cameras = cameras_for(model);

  Renderer oracle(model, "brute-force");
  std::vector<std::unique_ptr<JudgedTechnique>> techniques;
  for (const TechniqueInfo& technique : technique_table())
    if (technique.kind != TechniqueKind::kOracle && technique.kind != TechniqueKind::kPeer)
      techniques.push_back(std::make_unique<JudgedTechnique>(model, technique.id));

  FrameRequest request;
  request.width = request.height = config.side;
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

}  // namespace mdk
