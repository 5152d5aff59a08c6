// What the glTF tests compare with.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/base/error.h"
#include "common/motion/pose_sequence.h"

namespace mdk::test {

/// Positions of all vertices at a key, one after the other, to 1e-6.
inline void expect_pose(const PoseSequence& sequence, std::uint32_t key,
                        const std::vector<Vec3f>& expected) {
  SCOPED_TRACE("key " + std::to_string(key));
  ASSERT_LT(key, sequence.key_count());
  ASSERT_EQ(sequence.vertex_count, expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    SCOPED_TRACE("vertex " + std::to_string(i));
    EXPECT_NEAR(sequence.pose(key)[i].x, expected[i].x, 1e-6);
    EXPECT_NEAR(sequence.pose(key)[i].y, expected[i].y, 1e-6);
    EXPECT_NEAR(sequence.pose(key)[i].z, expected[i].z, 1e-6);
  }
}

/// Runs `body`, which must throw an Error of the code whose sentence holds each of the words.
template <class Body>
void expect_refused(ErrorCode code, const std::vector<std::string>& words, const Body& body) {
  try {
    body();
    ADD_FAILURE() << "was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    for (const std::string& word : words) EXPECT_THAT(error.what(), testing::HasSubstr(word));
    EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("\n")));
  }
}

}  // namespace mdk::test
