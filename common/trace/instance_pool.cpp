#include "common/trace/instance_pool.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "common/trace/query_keys.h"

namespace mdk {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Where rounding stops to matter, in units of 2^-24: products and sums of a few terms.
constexpr float kRounding = 0x1p-20f;

Aabb model_box(const ModelView& model, const KeyInterval& at) {
  const Aabb &from = model.key_boxes[at.key0], &to = model.key_boxes[at.key1];
  Aabb box;
  for (std::size_t k = 0; k < 3; ++k) {
    // Rounded outward by more than interpolating rounds, of boxes and of vertices.
    const float size = std::max({std::abs(from.lo[k]), std::abs(from.hi[k]), std::abs(to.lo[k]),
                                 std::abs(to.hi[k])}) *
                       kRounding;
    box.lo[k] = from.lo[k] + (to.lo[k] - from.lo[k]) * at.s - size;
    box.hi[k] = from.hi[k] + (to.hi[k] - from.hi[k]) * at.s + size;
  }
  return box;
}

float sum_of_sizes(const float* row) {
  return std::abs(row[0]) + std::abs(row[1]) + std::abs(row[2]);
}

/// The corner of the tile that a point is seen in, or the picture's own.
void choose_shift(const CrowdFrame& frame, const Vec3d& world, float& x, float& y) {
  const PixelFromWorld& map = frame.pixel_from_world;
  const Vec3d p = world - to_double(map.origin);
  const auto row = [&](int r) {
    return static_cast<double>(map.m[r][0]) * p.x + static_cast<double>(map.m[r][1]) * p.y +
           static_cast<double>(map.m[r][2]) * p.z;
  };
  const double z = row(2);
  const auto place = [&](double at, std::uint32_t side) {
    const double tiles = std::floor(at / z / kTileSide);
    const double last = (side - 1) / kTileSide;
    return z > 0 ? static_cast<float>(std::clamp(tiles, 0.0, last) * kTileSide) : 0.0f;
  };
  x = place(row(0), frame.width);
  y = place(row(1), frame.height);
  if (!(x >= 0 && y >= 0)) x = y = 0;  // no numbers
}

/// Bounds of a box in the image, in pixels from the shift, and its depths.
struct ImageBounds {
  float first_x = kInfinity, last_x = -kInfinity, first_y = kInfinity, last_y = -kInfinity;
  float nearest = kInfinity, farthest = -kInfinity;
};

}  // namespace

InstanceRays make_instance_rays(const CrowdFrame& frame, std::uint32_t instance) {
  const Stage& stage = *frame.stage;
  const std::uint32_t number = stage.role(instance).model;
  const CrowdModel& crowd = *frame.models[number];
  const ModelView& model = crowd.model();
  const Affine3f world_from_model = stage.world_from_model(instance, frame.time);
  const Affine3d model_from_world = inverse(to_double(world_from_model));

  InstanceRays r;
  r.instance = instance;
  r.at = r.time = stage.key_interval(instance, frame.time);
  r.model = &crowd.tracer().rays();
  r.segment = crowd.tracer().segment_at(r.at);
  r.vertices = {nullptr, nullptr, r.at.s};
  const Aabb box = model_box(model, r.at);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    r.lo[axis] = box.lo[axis];
    r.hi[axis] = box.hi[axis];
    r.size[axis] = std::max(std::abs(box.lo[axis]), std::abs(box.hi[axis]));
  }
  r.lo[3] = r.hi[3] = r.size[3] = 0;
  choose_shift(frame, to_double(world_from_model).point(to_double(box.center())), r.shift_x,
               r.shift_y);

  const PinholeRays& world = frame.rays;
  const Vec3f corner =
      to_float(to_double(world.corner) + to_double(world.du) * static_cast<double>(r.shift_x) +
               to_double(world.dv) * static_cast<double>(r.shift_y));
  r.rays = {map_point(model_from_world, world.origin), map_vector(model_from_world, corner),
            map_vector(model_from_world, world.du), map_vector(model_from_world, world.dv)};
  r.pixel_from_model = make_pixel_from_world(r.rays);

  // The box in the image. What rounding does to a corner is bounded by its row's size times its
  // own distance, over its depth.
  const PixelFromWorld& map = r.pixel_from_model;
  const Vec3f lo = box.lo - map.origin, hi = box.hi - map.origin;
  float reach[3], error[3];
  for (std::size_t k = 0; k < 3; ++k) reach[k] = std::max(std::abs(lo[k]), std::abs(hi[k]));
  for (int row = 0; row < 3; ++row)
    error[row] =
        kRounding * (std::abs(map.m[row][0]) * reach[0] + std::abs(map.m[row][1]) * reach[1] +
                     std::abs(map.m[row][2]) * reach[2]);
  ImageBounds image;
  for (int c = 0; c < 8; ++c) {
    const Vec3f p{(c & 1) != 0 ? hi.x : lo.x, (c & 2) != 0 ? hi.y : lo.y,
                  (c & 4) != 0 ? hi.z : lo.z};
    const auto row = [&](int i) {
      return map.m[i][0] * p.x + map.m[i][1] * p.y + map.m[i][2] * p.z;
    };
    const float z = row(2), inverse_z = 1 / z;
    const float x = row(0) * inverse_z, y = row(1) * inverse_z;
    image.nearest = std::min(image.nearest, z);
    image.farthest = std::max(image.farthest, z);
    image.first_x = std::min(image.first_x, x);
    image.last_x = std::max(image.last_x, x);
    image.first_y = std::min(image.first_y, y);
    image.last_y = std::max(image.last_y, y);
  }
  const float nearest = image.nearest - error[2];
  r.has_lines = false;
  r.line_slack = 0;
  r.line_reach = {};
  r.edges[0] = r.edges[1] = nullptr;
  r.longest_edge = 0;
  // Written so that what is no number counts as behind the eye.
  if (!(nearest > error[2] * 0x1p10f && nearest > 1e-20f && image.farthest < 1e20f)) {
    r.screen = {-kInfinity, kInfinity, -kInfinity, kInfinity, 0};
    return r;
  }
  const float inverse = 1 / nearest;
  // Coordinates of pixels that may be hit are no larger; nor need the margin be larger than what
  // rounding does to them.
  const float coordinates = std::max({std::abs(image.first_x), std::abs(image.last_x),
                                      std::abs(image.first_y), std::abs(image.last_y), 1.0f}) +
                            1;
  r.pixel_from_model.margin = std::min(kBoundsMargin, coordinates * 0x1p-15f);
  // Of a point at image x: its own error, and x times that of its depth.
  const auto pad = [&](int row, float first, float last) {
    const float most = std::max(std::abs(first), std::abs(last));
    return 2 * r.pixel_from_model.margin +
           (error[row] + most * (error[2] + nearest * kRounding)) * inverse;
  };
  const float pad_x = pad(0, image.first_x, image.last_x),
              pad_y = pad(1, image.first_y, image.last_y);
  const auto first = [](float at, float room, float shift) {
    return std::ceil(at - room - 0.5f) + 0.5f + shift;
  };
  const auto last = [](float at, float room, float shift) {
    return std::floor(at + room - 0.5f) + 0.5f + shift;
  };
  r.screen = {first(image.first_x, pad_x, r.shift_x), last(image.last_x, pad_x, r.shift_x),
              first(image.first_y, pad_y, r.shift_y), last(image.last_y, pad_y, r.shift_y),
              nearest};

  const float pixels =
      (r.screen.last_x - r.screen.first_x + 1) * (r.screen.last_y - r.screen.first_y + 1);
  if (!(pixels > 0 && pixels <= frame.line_share * static_cast<float>(model.triangle_count())))
    return r;

  // Lines. A pixel is hit where it is inside all edges, give or take what rounding does to them,
  // and within the margin of the corners' bounds. An edge of l pixels tells sides right past
  // K (1 + D / l) pixels, D the coordinates times the share that its depth changes by; so no
  // triangle is hit from farther off than the margin along a diagonal and 2 sqrt(6 K D) + 4 K
  // (docs/crowds.md).
  r.edges[0] = crowd.longest_edges(r.at.key0);
  r.edges[1] = crowd.longest_edges(r.at.key1);
  r.longest_edge = std::max(r.edges[0][r.model->clusters], r.edges[1][r.model->clusters]);
  const double most = static_cast<double>(coordinates),
               depth_per_length = static_cast<double>(sum_of_sizes(map.m[2]));
  const double depth_ratio = static_cast<double>(image.farthest * inverse);
  const double share =
      static_cast<double>(r.longest_edge) * depth_per_length * static_cast<double>(inverse);
  const double k = 0x1p-18 * most * depth_ratio * depth_ratio;
  const double off = 1.6 * static_cast<double>(r.pixel_from_model.margin) +
                     2 * std::sqrt(6 * k * most * share) + 4 * k;
  const double far = static_cast<double>(image.farthest);
  double slack = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double u = std::abs(static_cast<double>(r.rays.du[axis])),
                 v = std::abs(static_cast<double>(r.rays.dv[axis])),
                 w = std::abs(static_cast<double>(r.rays.corner[axis])) + most * (u + v);
    slack = std::max(slack, u * (static_cast<double>(error[0]) + off * far) +
                                v * (static_cast<double>(error[1]) + off * far) +
                                w * static_cast<double>(error[2]));
  }
  // What rounding the clusters' maps moves boxes by, and the direction of the line.
  const Vec3f center = model.bounds.center(), origin = r.rays.origin;
  const double distance =
      static_cast<double>(std::abs(center.x - origin.x) + std::abs(center.y - origin.y) +
                          std::abs(center.z - origin.z) + r.model->diagonal);
  slack += static_cast<double>(r.model->diagonal) * 0x1p-20 + distance * 0x1p-22;
  r.has_lines = true;
  r.line_slack = static_cast<float>(slack * (1 + 0x1p-10));
  r.line_reach = {static_cast<float>(3 * slack * depth_per_length * (1 + 0x1p-10)),
                  static_cast<float>(depth_per_length * (1 + 0x1p-10))};
  return r;
}

InstancePool::InstancePool(std::span<const std::unique_ptr<CrowdModel>> models, std::size_t bytes) {
  std::size_t clusters = 0;
  for (const auto& model : models)
    clusters = std::max<std::size_t>(clusters, model->model().cluster_count());
  const std::size_t each = sizeof(Place) + (clusters + 1) * (sizeof(FrustumForms) + 1);
  places_.resize(std::bit_floor(std::clamp<std::size_t>(bytes / each, 16, 4096)));
}

void InstancePool::begin_frame(const CrowdFrame& frame) {
  frame_ = &frame;
  ++serial_;
  posed_ = 0;
  current_ = nullptr;
}

void InstancePool::leave() {
  if (held_ == nullptr) return;
  held_->release(held_time_);
  held_ = nullptr;
}

const InstanceRays* InstancePool::enter(std::uint32_t instance) {
  leave();
  Place& place = places_[instance & (places_.size() - 1)];
  current_ = &place;
  if (place.serial != serial_ || place.rays.instance != instance) {
    place.serial = serial_;
    place.is_shown = frame_->stage->is_shown(instance, frame_->time);
    place.rays.instance = instance;
    if (place.is_shown) {
      place.rays = make_instance_rays(*frame_, instance);
      if (frame_->refitted != nullptr) frame_->refitted->replace(place.rays);
      ++posed_;
    }
    place.forms_of = kNoHit;
  }
  if (!place.is_shown) return nullptr;
  held_ = frame_->models[frame_->stage->role(instance).model]->tracer().rays().poses;
  held_time_ = place.rays.time;
  place.rays.vertices = held_->acquire(held_time_);
  return &place.rays;
}

void InstancePool::begin_forms() {
  const std::size_t count = current_->rays.model->clusters + 1;
  if (current_->forms.size() < count) {
    current_->forms.resize(count);
    current_->has_forms.resize(count);
  }
  std::fill_n(current_->has_forms.begin(), count, std::uint8_t{0});
  current_->forms_of = current_->rays.instance;
}

namespace {

/// How far pixels of the instance may stand left of or above its shift.
double pixels_before(const InstanceRays& r) {
  const float x = r.shift_x - std::max(r.screen.first_x, 0.0f),
              y = r.shift_y - std::max(r.screen.first_y, 0.0f);
  return static_cast<double>(std::max({x, y, 0.0f}) + kTileSide);
}

}  // namespace

const FrustumForms& InstancePool::model_forms() {
  if (current_->forms_of != current_->rays.instance) begin_forms();
  const std::size_t last = current_->rays.model->clusters;
  if (current_->has_forms[last] == 0) {
    current_->has_forms[last] = 1;
    const InstanceRays& r = current_->rays;
    const Aabb box{{r.lo[0], r.lo[1], r.lo[2]}, {r.hi[0], r.hi[1], r.hi[2]}};
    current_->forms[last] = make_frustum_forms(r.rays, Affine3d(), box, pixels_before(r));
  }
  return current_->forms[last];
}

const FrustumForms& InstancePool::cluster_forms(std::uint32_t c) {
  if (current_->forms_of != current_->rays.instance) begin_forms();
  if (current_->has_forms[c] == 0) {
    current_->has_forms[c] = 1;
    const InstanceRays& r = current_->rays;
    const RayModel& model = *r.model;
    const std::size_t a = std::size_t{r.at.key0} * model.clusters + c,
                      b = std::size_t{r.at.key1} * model.clusters + c;
    const RayTree& tree = model.trees[std::size_t{r.segment} * model.clusters + c];
    const Affine3d map = interpolate(model.local_from_world[a], model.local_from_world[b], r.at.s);
    current_->forms[c] = make_frustum_forms(r.rays, map, tree.nodes[0].box(), pixels_before(r));
  }
  return current_->forms[c];
}

std::size_t InstancePool::bytes() const {
  std::size_t sum = places_.size() * sizeof(Place);
  for (const Place& place : places_)
    sum += place.forms.capacity() * sizeof(FrustumForms) + place.has_forms.capacity();
  return sum;
}

}  // namespace mdk
