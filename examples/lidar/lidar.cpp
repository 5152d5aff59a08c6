// A spinning lidar over a moving character (README.md): lidar.py in C++17, over the C interface.
#include <mdk/mdk.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace {

constexpr std::size_t kBeams = 64, kAzimuths = 1800;
constexpr double kLowest = -25, kHighest = 15;  // degrees
constexpr double kPi = 3.141592653589793;

void check(mdk_status status) {
  if (status == MDK_OK) return;
  std::fprintf(stderr, "lidar: %s\n", mdk_last_error());
  std::exit(status);
}

struct Point {
  float x, y, z, time, doppler;
  uint32_t ring, azimuth, instance;
};
static_assert(sizeof(Point) == 32, "written as it is");

bool write(const std::string& path, const std::vector<Point>& points) {
  std::FILE* out = std::fopen(path.c_str(), "wb");
  if (out == nullptr) return false;
  const bool is_pcd = path.size() > 4 && path.compare(path.size() - 4, 4, ".pcd") == 0;
  if (is_pcd) {
    std::fprintf(out,
                 "VERSION .7\nFIELDS x y z time doppler ring azimuth instance\n"
                 "SIZE 4 4 4 4 4 4 4 4\nTYPE F F F F F U U U\nCOUNT 1 1 1 1 1 1 1 1\n"
                 "WIDTH %zu\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS %zu\nDATA binary\n",
                 points.size(), points.size());
  } else {
    std::fprintf(out, "ply\nformat binary_little_endian 1.0\nelement vertex %zu\n", points.size());
    for (const char* name : {"float x", "float y", "float z", "float time", "float doppler",
                             "uint ring", "uint azimuth", "uint instance"})
      std::fprintf(out, "property %s\n", name);
    std::fprintf(out, "end_header\n");
  }
  const bool all = std::fwrite(points.data(), sizeof(Point), points.size(), out) == points.size();
  return std::fclose(out) == 0 && all;
}

}  // namespace

int main(int argc, char** argv) {
  const char *model_path = nullptr, *out_path = nullptr, *clip_name = nullptr;
  double seconds = -1;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--clip") == 0 && i + 1 < argc) {
      clip_name = argv[++i];
    } else if (std::strcmp(argv[i], "--seconds") == 0 && i + 1 < argc) {
      seconds = std::atof(argv[++i]);
    } else {
      (model_path == nullptr ? model_path : out_path) = argv[i];
    }
  }
  if (out_path == nullptr) {
    std::fprintf(stderr, "usage: lidar MODEL.mdk OUT.ply|OUT.pcd [--clip NAME] [--seconds S]\n");
    return 2;
  }

  mdk_model* model = nullptr;
  check(mdk_model_load(model_path, &model));
  uint32_t clip = 0;
  if (clip_name != nullptr) check(mdk_model_find_clip(model, clip_name, &clip));
  mdk_clip_info clip_info;
  mdk_clip_info_init(&clip_info);
  check(mdk_model_get_clip(model, clip, &clip_info));
  if (seconds < 0) seconds = clip_info.seconds;
  mdk_model_info info;
  mdk_model_info_init(&info);
  check(mdk_model_get_info(model, &info));

  // From beside the model; a column of beams fires at once.
  double low[3], high[3], square = 0;
  for (int k = 0; k < 3; ++k) {
    low[k] = static_cast<double>(info.bounds_low[k]);
    high[k] = static_cast<double>(info.bounds_high[k]);
    square += (high[k] - low[k]) * (high[k] - low[k]);
  }
  const double size = std::sqrt(square);
  const float origin[3] = {static_cast<float>((low[0] + high[0]) / 2 + 0.6 * size),
                           static_cast<float>((low[1] + high[1]) / 2 + 0.1 * size),
                           static_cast<float>((low[2] + high[2]) / 2)};
  std::vector<float> directions;
  std::vector<double> times;
  for (std::size_t a = 0; a < kAzimuths; ++a)
    for (std::size_t b = 0; b < kBeams; ++b) {
      const double angle = 2 * kPi * static_cast<double>(a) / kAzimuths;
      const double up =
          (kLowest + (kHighest - kLowest) * static_cast<double>(b) / (kBeams - 1)) * (kPi / 180);
      directions.push_back(static_cast<float>(std::cos(angle) * std::cos(up)));
      directions.push_back(static_cast<float>(std::sin(up)));
      directions.push_back(static_cast<float>(std::sin(angle) * std::cos(up)));
      times.push_back(seconds * static_cast<double>(a) / kAzimuths);
    }

  const std::size_t count = times.size();
  mdk_rays rays;
  mdk_rays_init(&rays, count, origin, directions.data());
  rays.origin_stride = 0;  // one origin for all
  rays.times = times.data();
  rays.clip = clip;
  rays.wrap = MDK_WRAP_LOOP;
  std::vector<uint32_t> triangle(count), instance(count);
  std::vector<float> position(3 * count), velocity(3 * count);
  mdk_hits hits;
  mdk_hits_init(&hits);
  hits.triangle = triangle.data();
  hits.instance = instance.data();
  hits.position = position.data();
  hits.velocity = velocity.data();
  check(mdk_cast(model, &rays, &hits));

  std::vector<Point> points;
  for (std::size_t i = 0; i < count; ++i) {
    if (triangle[i] == MDK_NONE) continue;
    const float *p = &position[3 * i], *v = &velocity[3 * i], *d = &directions[3 * i];
    points.push_back({p[0], p[1], p[2], static_cast<float>(times[i]),
                      v[0] * d[0] + v[1] * d[1] + v[2] * d[2],
                      static_cast<uint32_t>(i % kBeams), static_cast<uint32_t>(i / kBeams),
                      instance[i]});
  }
  mdk_model_release(model);
  if (!write(out_path, points)) {
    std::fprintf(stderr, "lidar: cannot write %s\n", out_path);
    return 4;
  }
  std::printf("%zu of %zu rays hit\n", points.size(), count);
  return 0;
}
