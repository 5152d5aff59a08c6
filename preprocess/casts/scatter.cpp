#include "preprocess/casts/scatter.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace mdk {
namespace {

constexpr double kPi = std::numbers::pi;

/// Where one stands: on the ground x to the right, y to the back, z up; heading as upright_map()
/// has it, 0 looking at whoever stands in front.
struct Spot {
  double x = 0, y = 0, z = 0, heading = 0;
};

std::vector<Spot> grid(std::uint32_t count, double spacing, bool shifted) {
  const auto side = static_cast<std::uint32_t>(std::ceil(std::sqrt(count)));
  std::vector<Spot> spots;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t row = i / side, place = i % side;
    const double shift = shifted && row % 2 == 1 ? 0.5 : 0;
    spots.push_back(
        {(place + shift - 0.5 * (side - 1)) * spacing, row * spacing * (shifted ? 1.25 : 1), 0, 0});
  }
  return spots;
}

/// Sunflower seeds: even everywhere, without rows.
std::vector<Spot> disc(std::uint32_t count, double spacing, std::mt19937_64& random) {
  const double turn = kPi * (3 - std::sqrt(5.0));
  std::vector<Spot> spots;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double radius = spacing * std::sqrt((i + 0.5) / kPi) * 1.05, angle = turn * i;
    spots.push_back({radius * std::cos(angle), radius * std::sin(angle), 0,
                     static_cast<double>(random() >> 11) * 0x1p-53 * 2 * kPi});
  }
  return spots;
}

/// Stands around a field, each ring higher than the one before; all look at the middle. Rings are
/// rectangles with round corners, as stands are.
std::vector<Spot> stadium(std::uint32_t count, double spacing) {
  const double depth = 1.2 * spacing, rise = 0.55 * spacing;
  // The field grows with the crowd, and the stands with it: about as many rings as a ring has
  // twentieths.
  const double side = spacing * std::sqrt(count) * 0.45;
  std::vector<Spot> spots;
  for (std::uint32_t ring = 0; spots.size() < count; ++ring) {
    const double corner = 0.4 * side + ring * depth;  // radius of the corners
    const double half_x = 0.6 * side, half_y = 0.25 * side;
    const double straight_x = 2 * half_x, straight_y = 2 * half_y, bend = 0.5 * kPi * corner;
    const double round = 2 * (straight_x + straight_y) + 4 * bend;
    const auto seats = std::max(1u, static_cast<std::uint32_t>(round / spacing));
    for (std::uint32_t seat = 0; seat < seats && spots.size() < count; ++seat) {
      double way = (seat + (ring % 2 == 1 ? 0.5 : 0)) * round / seats;
      // Counter-clockwise from the middle of the far side; a quarter at a time.
      Spot spot;
      double angle = kPi / 2;  // of the outward direction
      double x = half_x, y = half_y + corner;
      const double parts[] = {straight_x, bend, straight_y, bend,
                              straight_x, bend, straight_y, bend};
      int part = 0;
      while (part < 7 && way >= parts[part]) way -= parts[part++];
      const double quarter = part / 2 * kPi / 2;
      const bool is_straight = part % 2 == 0;
      // In the frame of the quarter: outward is up, the way goes to the left.
      const double half_along = part / 2 % 2 == 0 ? half_x : half_y;
      const double half_across = part / 2 % 2 == 0 ? half_y : half_x;
      if (is_straight) {
        x = half_along - way;
        y = half_across + corner;
      } else {
        const double turned = way / corner;
        x = -half_along - corner * std::sin(turned);
        y = half_across + corner * std::cos(turned);
        angle += turned;
      }
      angle += quarter;
      spot.x = x * std::cos(quarter) - y * std::sin(quarter);
      spot.y = x * std::sin(quarter) + y * std::cos(quarter);
      spot.z = ring * rise;
      spot.heading = angle - kPi / 2;  // looks against the outward direction
      spots.push_back(spot);
    }
  }
  return spots;
}

double width_of(const Aabb& bounds, UpAxis up) {
  const Vec3f size = bounds.extent();
  return static_cast<double>(std::max(size.x, up == UpAxis::kY ? size.z : size.y));
}

}  // namespace

void scatter(const ScatterOptions& scatter, const CastOptions& options, SceneBuilder& scene) {
  std::mt19937_64 random(scatter.seed);
  const auto share = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<std::uint32_t> models;
  std::vector<std::vector<std::uint32_t>> clips;
  double width = 0;
  for (const std::string& path : options.models) {
    models.push_back(scene.model(path));
    const ModelView& view = scene.view(models.back());
    width = std::max(width, width_of(view.bounds, options.up));
    std::vector<std::uint32_t>& moving = clips.emplace_back();
    for (std::uint32_t c = 0; c < view.clips.size(); ++c)
      if (options.clip.empty() ? view.clips[c].key_count > 1 : view.clips[c].name == options.clip)
        moving.push_back(c);
    if (moving.empty() && !options.clip.empty())
      throw bad_input(path,
                      "has no clip \"" + options.clip + "\"; leave --clip out, or name another");
    if (moving.empty()) moving.push_back(0);
  }
  const double spacing = scatter.spacing.value_or(width > 0 ? 1.1 * width * options.scale : 1);

  std::vector<Spot> spots;
  switch (scatter.pattern) {
    case ScatterPattern::kGrid:
      spots = grid(scatter.count, spacing, false);
      break;
    case ScatterPattern::kRows:
      spots = grid(scatter.count, spacing, true);
      break;
    case ScatterPattern::kDisc:
      spots = disc(scatter.count, spacing, random);
      break;
    case ScatterPattern::kStadium:
      spots = stadium(scatter.count, spacing);
      break;
  }
  for (const Spot& spot : spots) {
    const auto which = static_cast<std::size_t>(random() % models.size());
    const ModelView& view = scene.view(models[which]);
    const std::uint32_t clip = clips[which][random() % clips[which].size()];
    const Clip& played = view.clips[clip];
    const double ground =
        options.scale *
        static_cast<double>(options.up == UpAxis::kY ? view.bounds.lo.y : view.bounds.lo.z);
    // The ground's y runs away from the viewer, who stands at +z where y is up, at -y where z is.
    const Vec3d at = options.up == UpAxis::kY ? Vec3d{spot.x, spot.z - ground, -spot.y}
                                              : Vec3d{spot.x, spot.y, spot.z - ground};
    Actor actor;
    actor.model = models[which];
    actor.clip = played.name;
    actor.map = upright_map(at, spot.heading, options.scale, options.up);
    actor.start = share() * view.clip_seconds(played);
    if (const std::string fault = scene.add(actor); !fault.empty())
      throw Error(ErrorCode::kUsage, "--spacing: " + fault);
  }
}

}  // namespace mdk
