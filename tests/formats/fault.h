// Fault: one way to break a sample model, and the sentence that has to name it.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <ostream>
#include <string>

#include "tests/formats/sample_model.h"

namespace mdk::test {

struct Fault {
  std::string name;
  std::string sentence;  ///< how it must begin
  std::function<void(ModelStorage&)> make;
};

inline void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }

inline std::string fault_name(const testing::TestParamInfo<Fault>& info) { return info.param.name; }

}  // namespace mdk::test
