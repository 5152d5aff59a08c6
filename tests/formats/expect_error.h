// What a refused call must look like: an Error with a code and words in its sentence.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "common/base/error.h"

namespace mdk::test {

/// Calls `action`, which must throw Error with `code` and a sentence that holds `words`.
template <class Action>
void expect_error(ErrorCode code, const std::string& words, Action&& action) {
  try {
    action();
    ADD_FAILURE() << "nothing was thrown, expected: " << words;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    EXPECT_THAT(error.what(), testing::HasSubstr(words));
  }
}

}  // namespace mdk::test
