// libmdk.so: what it exports, that C programs can use it, and that many threads can.
#include <gmock/gmock.h>

#include <cstdint>
#include <cstdio>
#include <random>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "mdk/mdk.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

/// What a line of shell prints.
std::string output_of(const std::string& line) {
  std::string out;
  std::FILE* pipe = popen(line.c_str(), "r");
  if (pipe == nullptr) return out;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) out += static_cast<char>(c);
  pclose(pipe);
  return out;
}

TEST(Library, ExportsItsCFunctionsAlone) {
  std::istringstream list(output_of("nm -D --defined-only \"" MDK_LIBRARY "\" | awk '{print $3}'"));
  int count = 0;
  for (std::string name; list >> name; ++count)
    EXPECT_TRUE(name.rfind("mdk_", 0) == 0 || name == "MDK_0") << name;
  EXPECT_GT(count, 20);
  EXPECT_THAT(output_of("objdump -p \"" MDK_LIBRARY "\""), testing::HasSubstr("libmdk.so.0\n"));
}

TEST(Library, ServesAProgramInC99) {
  const TempFolder folder;
  EXPECT_EQ(output_of("\"" MDK_C_CLIENT "\" '" + folder.file("square.mdk") + "' 2>&1"),
            "all is as it must be\n");
}

/// A strip of squares that waves, baked.
mdk_model* waving_strip() {
  constexpr std::uint32_t kKeys = 5, kColumns = 40;
  std::vector<float> vertices;
  std::vector<std::uint32_t> faces;
  for (std::uint32_t k = 0; k < kKeys; ++k)
    for (std::uint32_t i = 0; i <= kColumns; ++i)
      for (int side = 0; side < 2; ++side) {
        vertices.push_back(static_cast<float>(i) * 0.1f);
        vertices.push_back(static_cast<float>(side));
        vertices.push_back(static_cast<float>((i * (k + 1)) % 7) * 0.1f);
      }
  for (std::uint32_t i = 0; i < kColumns; ++i)
    for (const std::uint32_t v : {2 * i, 2 * i + 2, 2 * i + 3, 2 * i, 2 * i + 3, 2 * i + 1})
      faces.push_back(v);
  mdk_mesh mesh;
  mdk_mesh_init(&mesh, kKeys, 2 * (kColumns + 1), faces.size() / 3, vertices.data(), faces.data());
  mdk_model* model = nullptr;
  EXPECT_EQ(mdk_bake(&mesh, nullptr, &model), MDK_OK) << mdk_last_error();
  return model;
}

TEST(Library, GivesTheSameBitsToManyThreadsOnColdCaches) {
  constexpr std::size_t kRays = 2000;
  mdk_model* model = waving_strip();
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<float> origins, directions;
  std::vector<double> times;
  for (std::size_t i = 0; i < kRays; ++i) {
    for (const float v : {4 * unit(random), unit(random), 3.0f}) origins.push_back(v);
    for (const float v : {unit(random) - 0.5f, 0.0f, -2.0f}) directions.push_back(v);
    times.push_back(static_cast<double>(unit(random)) * 3);
  }
  const auto cast = [&](std::uint32_t threads, std::vector<float>& t,
                        std::vector<float>& velocity) {
    t.resize(kRays);
    velocity.resize(3 * kRays);
    mdk_rays rays;
    mdk_rays_init(&rays, kRays, origins.data(), directions.data());
    rays.times = times.data();
    rays.threads = threads;
    mdk_hits hits;
    mdk_hits_init(&hits);
    hits.t = t.data();
    hits.velocity = velocity.data();
    EXPECT_EQ(mdk_cast(model, &rays, &hits), MDK_OK) << mdk_last_error();
  };
  std::vector<float> t[4], velocity[4];
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&, i] { cast(i % 2 == 0 ? 1 : 0, t[i], velocity[i]); });
  for (std::thread& thread : threads) thread.join();
  for (int i = 1; i < 4; ++i) {
    EXPECT_EQ(t[i], t[0]);
    EXPECT_EQ(velocity[i], velocity[0]);
  }
  mdk_model_release(model);
}

}  // namespace
}  // namespace mdk::test
