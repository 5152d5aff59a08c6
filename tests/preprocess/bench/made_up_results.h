// Bench results made up for tests: small, and with figures that are easy to check by hand.
#pragma once

#include <string>

#include "preprocess/bench/results.h"

namespace mdk::test {

/// Three keys with updates of 3, 1, 2 ms, traces ten times that, pose 0.5 and shade 4 ms, all times
/// `factor`; 100 rays each. Over all frames: 900 visits, 600 tests, 150 clusters.
TechniqueBench made_up_technique(const std::string& id, double factor = 1);

/// A bake with three stages of growth.
BakeFacts made_up_bake();

/// "hand", baked, with every kind of technique, and "hand-split1" with four times the triangles, on
/// avx2 with one thread at 10x10; as `further_runs`, "hand" with two threads.
BenchResults made_up_results();

}  // namespace mdk::test
