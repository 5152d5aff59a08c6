// The chooser with made-up candidates whose costs are known and far apart.
#include "common/trace/techniques/technique_chooser.h"

#include <gtest/gtest.h>

#include <atomic>

#include "common/base/stopwatch.h"

namespace mdk {
namespace {

constexpr double kCheapMs = 0.001, kExpensiveMs = 0.05;

std::atomic<int> expensive_updates;

/// Spins for a while per tile, and says in every hit who it was.
template <int kId>
class SpinningTechnique final : public Technique {
 public:
  SpinningTechnique() : cost_ms_(kId == 0 ? kExpensiveMs : kCheapMs) {}
  void update(const PosedMesh&) override { expensive_updates += kId == 0; }
  void occlude(RayBeam&, TileScratch&) const override {}
  bool trace(const TileRays&, TileHits& hits, TileScratch&,
             TraceCounters* counters) const override {
    const Stopwatch watch;
    while (watch.milliseconds() < cost_ms_) {
    }
    hits.triangle[0] = kId;
    if (counters != nullptr) ++counters->node_visits;
    return true;
  }
  std::size_t structure_bytes() const override { return 100; }

 private:
  double cost_ms_;
};

template <int kId>
std::unique_ptr<Technique> make_spinning(const ModelView&) {
  return std::make_unique<SpinningTechnique<kId>>();
}

constexpr TechniqueCandidate kExpensiveFirst[] = {{"expensive", make_spinning<0>},
                                                  {"cheap", make_spinning<1>}};
constexpr TechniqueCandidate kCheapFirst[] = {{"cheap", make_spinning<1>},
                                              {"expensive", make_spinning<0>}};

class TechniqueChooserTest : public testing::Test {
 protected:
  TechniqueChooserTest() {
    storage_.vertex_count = 1;
    storage_.key_times = {0};
    storage_.poses.key_positions = {{0, 0, 0}};
    storage_.bounds = {{-1, -1, -1}, {1, 1, 1}};
    expensive_updates = 0;
  }

  /// Plays frames of 16x16 tiles; returns whose hits the last frame shows.
  std::uint32_t play(TechniqueChooser& chooser, const Camera& camera, int frames) {
    const PosedMesh mesh = posed();
    const PinholeRays rays = make_pinhole_rays(camera, 256, 256);
    TileHits hits;
    for (int frame = 0; frame < frames; ++frame) {
      chooser.prebuild(mesh);
      chooser.update(mesh);
      chooser.set_view(rays);
      std::uint32_t shown = kNoHit;
      for (std::uint32_t tile = 0; tile < 256; ++tile) {
        const TileRays tile_rays{&rays, nullptr, tile % 16 * 16, tile / 16 * 16};
        EXPECT_TRUE(chooser.trace(tile_rays, hits, scratch_, &counters_));
        if (tile > 0) {
          EXPECT_EQ(hits.triangle[0], shown) << "one frame, two techniques";
        }
        shown = hits.triangle[0];
      }
      shown_ = shown;
    }
    return shown_;
  }

  PosedMesh posed() {
    PosedMesh mesh(model_ = storage_.view());
    mesh.set_time(at_key(0));
    return mesh;
  }

  ModelStorage storage_;
  ModelView model_;
  TileScratch scratch_;
  TraceCounters counters_;
  std::uint32_t shown_ = kNoHit;
  const Camera near_{.eye = {0, 0, 3}}, far_{.eye = {0, 0, 30}};
};

TEST_F(TechniqueChooserTest, SettlesOnTheCheapestWhereverItStands) {
  for (const auto& candidates : {std::span(kExpensiveFirst), std::span(kCheapFirst)}) {
    TechniqueChooser chooser(model_, candidates);
    EXPECT_EQ(play(chooser, near_, 12), 1u);
    EXPECT_EQ(chooser.note().rfind("cheap, ", 0), 0u) << chooser.note();
    EXPECT_NE(chooser.note().find("expensive +"), std::string::npos) << chooser.note();
  }
}

TEST_F(TechniqueChooserTest, TriesAHopelessCandidateSeldom) {
  TechniqueChooser chooser(model_, kCheapFirst);
  play(chooser, near_, 12);
  const int at_first = expensive_updates;
  EXPECT_GE(at_first, 1);
  EXPECT_LE(at_first, 2);
  play(chooser, near_, 60);
  EXPECT_LE(expensive_updates, at_first + 1);
}

TEST_F(TechniqueChooserTest, RemembersAViewItKnows) {
  TechniqueChooser chooser(model_, kCheapFirst);
  play(chooser, near_, 6);
  play(chooser, far_, 6);
  const int tried = expensive_updates;
  EXPECT_GE(tried, 2) << "a new view is measured anew";
  play(chooser, near_, 6);
  play(chooser, far_, 6);
  EXPECT_EQ(expensive_updates, tried);
}

TEST_F(TechniqueChooserTest, CountsOnlyTheWorkThatMadeThePicture) {
  TechniqueChooser chooser(model_, kCheapFirst);
  play(chooser, near_, 8);
  EXPECT_EQ(counters_.node_visits, 8u * 256);
}

TEST_F(TechniqueChooserTest, SaysNothingBeforeTheFirstFrame) {
  TechniqueChooser chooser(model_, kCheapFirst);
  EXPECT_EQ(chooser.note(), "");
  EXPECT_EQ(chooser.structure_bytes(), 0u);
}

}  // namespace
}  // namespace mdk
