// Rays and points in C (mdk.h).
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <vector>

#include "common/base/parallel.h"
#include "preprocess/library/c_call.h"

namespace {

using mdk::KeyInterval;
using mdk::QueryHit;
using mdk::QueryRay;
using mdk::Vec3f;
using mdk::c::call;
using mdk::c::refuse;
using mdk::c::require;

constexpr std::size_t kPerChunk = 64;
constexpr std::size_t kTooMany = std::size_t{1} << 32;

/// One list of a caller's: an item every `stride` bytes, which need not be aligned.
template <class T>
struct Strided {
  const T* first;
  std::size_t stride;

  T at(std::size_t i, std::size_t component = 0) const {
    T value;
    std::memcpy(&value, reinterpret_cast<const char*>(first) + i * stride + component * sizeof(T),
                sizeof(T));
    return value;
  }
  Vec3f point(std::size_t i) const {
    if constexpr (std::is_same_v<T, float>) return {at(i, 0), at(i, 1), at(i, 2)};
  }
};

bool is_finite(const Vec3f& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

std::string item(const char* list, std::size_t i, const char* fault) {
  return std::string(list) + ": number " + std::to_string(i) + " is " + fault;
}

/// Throws Error (kUsage) that names the first of `count` items for which is_bad(i), and `list`.
template <class IsBad>
void require_none(std::size_t count, const IsBad& is_bad, const char* list, const char* fault) {
  std::atomic<std::size_t> first = count;
  mdk::parallel_chunks(count, std::size_t{1} << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!is_bad(i)) continue;
      std::size_t known = first;
      while (i < known && !first.compare_exchange_weak(known, i)) {
      }
      return;
    }
  });
  if (first < count) refuse(item(list, first, fault));
}

/// When each item is looked at.
class Times {
 public:
  Times(const mdk::Model& model, const double* times, std::size_t stride, std::uint32_t clip,
        mdk_wrap wrap)
      : model_(model), times_{times, stride}, clip_(clip), wrap_(mdk::c::wrap_of(wrap)) {
    seconds_ = model.clip(clip).seconds;  // throws for a clip that is not there
  }
  void require_finite(std::size_t count) const {
    if (times_.first == nullptr) return;
    require_none(
        times_.stride == 0 ? std::min<std::size_t>(count, 1) : count,
        [&](std::size_t i) { return !std::isfinite(times_.at(i)); }, "times", "not finite");
  }

  double seconds(std::size_t i) const { return times_.first == nullptr ? 0 : times_.at(i); }
  KeyInterval at(std::size_t i) const { return model_.locate_time(clip_, seconds(i), wrap_); }
  /// Clip seconds a second of time: 1, or -1 while a ping-pong runs backwards, or 0 where once is
  /// over.
  float rate(std::size_t i) const {
    const double time = seconds(i);
    if (wrap_ == mdk::ClipWrap::kOnce) return time >= 0 && time < seconds_ ? 1.0f : 0.0f;
    if (wrap_ == mdk::ClipWrap::kLoop || !(seconds_ > 0)) return 1;
    double round = std::fmod(time, 2 * seconds_);
    if (round < 0) round += 2 * seconds_;
    return round < seconds_ ? 1.0f : -1.0f;
  }

 private:
  const mdk::Model& model_;
  Strided<double> times_;
  std::uint32_t clip_;
  mdk::ClipWrap wrap_;
  double seconds_;
};

/// The rays of a call.
class Rays {
 public:
  Rays(const mdk::Model& model, const mdk_rays* given)
      : rays_(mdk::c::read_struct(given, "rays")),
        times_(model, rays_.times, rays_.time_stride, rays_.clip, rays_.wrap) {
    if (rays_.count >= kTooMany) refuse("rays: count must be below 2^32");
    if (rays_.count == 0) return;
    require(rays_.origins, "rays: origins");
    require(rays_.directions, "rays: directions");
    times_.require_finite(rays_.count);
    require_finite_points(rays_.origins, rays_.origin_stride, "origins");
    require_finite_points(rays_.directions, rays_.direction_stride, "directions");
    const Strided<float> t_min{rays_.t_min, rays_.t_min_stride};
    const Strided<float> t_max{rays_.t_max, rays_.t_max_stride};
    if (t_min.first != nullptr)
      require_none(
          rays_.count, [&](std::size_t i) { return std::isnan(t_min.at(i)); }, "t_min",
          "not a number");
    if (t_max.first != nullptr)
      require_none(
          rays_.count, [&](std::size_t i) { return std::isnan(t_max.at(i)); }, "t_max",
          "not a number");
  }

  std::size_t count() const { return rays_.count; }
  int threads() const { return static_cast<int>(std::min(rays_.threads, 1u << 16)); }
  const Times& times() const { return times_; }
  /// Those from `begin` to `end`.
  void read(std::size_t begin, std::size_t end, QueryRay* rays, KeyInterval* times) const {
    for (std::size_t i = begin; i < end; ++i) {
      rays[i - begin] = at(i);
      times[i - begin] = times_.at(i);
    }
  }
  QueryRay at(std::size_t i) const {
    QueryRay ray{Strided<float>{rays_.origins, rays_.origin_stride}.point(i),
                 Strided<float>{rays_.directions, rays_.direction_stride}.point(i)};
    if (rays_.t_min != nullptr) ray.t_min = Strided<float>{rays_.t_min, rays_.t_min_stride}.at(i);
    if (rays_.t_max != nullptr) ray.t_max = Strided<float>{rays_.t_max, rays_.t_max_stride}.at(i);
    return ray;
  }

 private:
  void require_finite_points(const float* first, std::size_t stride, const char* list) const {
    const Strided<float> points{first, stride};
    require_none(
        stride == 0 ? 1 : rays_.count, [&](std::size_t i) { return !is_finite(points.point(i)); },
        list, "not finite");
  }

  mdk_rays rays_;
  Times times_;
};

/// Lists that hits are written to.
class Hits {
 public:
  explicit Hits(const mdk_hits* given) : hits_(mdk::c::read_struct(given, "hits")) {
    using mdk::SurfaceParts;
    needs_surface_ = hits_.source_triangle || hits_.position || hits_.normal ||
                     hits_.smooth_normal || hits_.velocity || hits_.texcoord || hits_.material ||
                     hits_.base_color;
    if (hits_.smooth_normal) parts_ = parts_ | SurfaceParts::kSmoothNormal;
    if (hits_.velocity) parts_ = parts_ | SurfaceParts::kVelocity;
    if (hits_.texcoord || hits_.base_color) parts_ = parts_ | SurfaceParts::kPaint;
  }

  void write(std::size_t i, const mdk::RayQuery& query, const QueryHit& hit,
             const KeyInterval& time, float rate) const {
    if (hits_.t) hits_.t[i] = hit.t;
    if (hits_.triangle) hits_.triangle[i] = hit.triangle;
    if (hits_.uv) {
      hits_.uv[2 * i] = hit.bary1;
      hits_.uv[2 * i + 1] = hit.bary2;
    }
    if (hits_.instance) hits_.instance[i] = hit.is_hit() ? 0 : MDK_NONE;
    if (hits_.id) hits_.id[i] = 0;
    if (!needs_surface_) return;
    mdk::Surface surface;
    if (hit.is_hit()) {
      surface = query.surface(hit, time, parts_);
      // Played backwards from a key, it is the interval before it that comes next: the one that
      // goes on from the key before.
      if (rate < 0 && hits_.velocity != nullptr && time.key0 == time.key1 && time.key0 > 0)
        surface.velocity =
            query.surface(hit, {time.key0 - 1, time.key0 - 1, 0}, mdk::SurfaceParts::kVelocity)
                .velocity;
    } else {
      surface.source_triangle = surface.material = MDK_NONE;
    }
    if (hits_.source_triangle) hits_.source_triangle[i] = surface.source_triangle;
    if (hits_.material) hits_.material[i] = surface.material;
    write(hits_.position, i, surface.position);
    write(hits_.normal, i, surface.normal);
    write(hits_.smooth_normal, i, surface.smooth_normal);
    write(hits_.velocity, i, surface.velocity * rate);
    if (hits_.texcoord) {
      hits_.texcoord[2 * i] = surface.u;
      hits_.texcoord[2 * i + 1] = surface.v;
    }
    if (hits_.base_color) std::copy_n(surface.base_color, 4, hits_.base_color + 4 * i);
  }

 private:
  static void write(float* list, std::size_t i, const Vec3f& v) {
    if (list == nullptr) return;
    list[3 * i] = v.x;
    list[3 * i + 1] = v.y;
    list[3 * i + 2] = v.z;
  }

  mdk_hits hits_;
  bool needs_surface_ = false;
  mdk::SurfaceParts parts_ = mdk::SurfaceParts::kPlain;
};

/// visit(i) for each of `count`, in parallel.
template <class Visit>
void for_each_item(std::size_t count, int threads, const Visit& visit) {
  const mdk::ThreadLimit limit(threads);
  mdk::parallel_chunks(count, kPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) visit(i);
  });
}

}  // namespace

void mdk_rays_init(mdk_rays* rays, size_t count, const float* origins, const float* directions) {
  if (rays == nullptr) return;
  *rays = {};
  rays->struct_size = sizeof *rays;
  rays->count = count;
  rays->origins = origins;
  rays->directions = directions;
  rays->origin_stride = rays->direction_stride = 3 * sizeof(float);
  rays->t_min_stride = rays->t_max_stride = sizeof(float);
  rays->time_stride = sizeof(double);
  rays->mask_stride = sizeof(uint32_t);
  rays->wrap = MDK_WRAP_ONCE;
}

void mdk_hits_init(mdk_hits* hits) {
  if (hits == nullptr) return;
  *hits = {};
  hits->struct_size = sizeof *hits;
}

void mdk_points_init(mdk_points* points, size_t count, const float* xyz) {
  if (points == nullptr) return;
  *points = {};
  points->struct_size = sizeof *points;
  points->count = count;
  points->points = xyz;
  points->point_stride = 3 * sizeof(float);
  points->radius_stride = sizeof(float);
  points->time_stride = sizeof(double);
  points->wrap = MDK_WRAP_ONCE;
}

mdk_status mdk_cast(mdk_model* model, const mdk_rays* rays, const mdk_hits* hits) {
  return call([&] {
    require(model, "model");
    const Rays list(model->model, rays);
    const Hits out(hits);
    const mdk::RayQuery& query = model->query();
    const mdk::ThreadLimit limit(list.threads());
    mdk::parallel_chunks(list.count(), kPerChunk, [&](std::size_t begin, std::size_t end) {
      QueryRay some[kPerChunk];
      KeyInterval times[kPerChunk];
      QueryHit found[kPerChunk];
      list.read(begin, end, some, times);
      query.closest_hits(some, times, found, end - begin);
      for (std::size_t i = begin; i < end; ++i)
        out.write(i, query, found[i - begin], times[i - begin], list.times().rate(i));
    });
  });
}

mdk_status mdk_occluded(mdk_model* model, const mdk_rays* rays, uint8_t* occluded) {
  return call([&] {
    require(model, "model");
    const Rays list(model->model, rays);
    if (list.count() > 0) require(occluded, "occluded");
    const mdk::RayQuery& query = model->query();
    const mdk::ThreadLimit limit(list.threads());
    mdk::parallel_chunks(list.count(), kPerChunk, [&](std::size_t begin, std::size_t end) {
      QueryRay some[kPerChunk];
      KeyInterval times[kPerChunk];
      list.read(begin, end, some, times);
      query.any_hits(some, times, occluded + begin, end - begin);
    });
  });
}

mdk_status mdk_all_hits(mdk_model* model, const mdk_rays* rays, uint32_t per_ray,
                        const mdk_hits* hits, uint32_t* counts) {
  return call([&] {
    require(model, "model");
    const Rays list(model->model, rays);
    const Hits out(hits);
    if (list.count() > 0) require(counts, "counts");
    if (list.count() * per_ray >= kTooMany) refuse("per_ray times the rays must be below 2^32");
    const mdk::RayQuery& query = model->query();
    for_each_item(list.count(), list.threads(), [&](std::size_t i) {
      const KeyInterval time = list.times().at(i);
      const std::vector<QueryHit> found = query.all_hits(list.at(i), time);
      counts[i] = static_cast<std::uint32_t>(found.size());
      for (std::size_t k = 0; k < per_ray; ++k)
        out.write(i * per_ray + k, query, k < found.size() ? found[k] : QueryHit{}, time,
                  list.times().rate(i));
    });
  });
}

mdk_status mdk_closest_points(mdk_model* model, const mdk_points* points, const mdk_hits* hits) {
  return call([&] {
    require(model, "model");
    const mdk_points list = mdk::c::read_struct(points, "points");
    const Hits out(hits);
    const Times times(model->model, list.times, list.time_stride, list.clip, list.wrap);
    if (list.count >= kTooMany) refuse("points: count must be below 2^32");
    const Strided<float> points_in{list.points, list.point_stride};
    const Strided<float> radii{list.radii, list.radius_stride};
    if (list.count > 0) {
      require(list.points, "points: points");
      times.require_finite(list.count);
      require_none(
          list.count, [&](std::size_t i) { return !is_finite(points_in.point(i)); }, "points",
          "not finite");
      if (radii.first != nullptr)
        require_none(
            list.count, [&](std::size_t i) { return std::isnan(radii.at(i)); }, "radii",
            "not a number");
    }
    const mdk::RayQuery& query = model->query();
    for_each_item(
        list.count, static_cast<int>(std::min(list.threads, 1u << 16)), [&](std::size_t i) {
          const Vec3f p = points_in.point(i);
          const float radius =
              radii.first == nullptr ? std::numeric_limits<float>::infinity() : radii.at(i);
          const KeyInterval time = times.at(i);
          out.write(i, query, query.closest_point(p, radius, time), time, times.rate(i));
        });
  });
}
