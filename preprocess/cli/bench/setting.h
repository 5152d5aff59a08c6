// What a result was measured on and with.
#pragma once

#include <string>

#include "preprocess/cli/bench/results.h"

namespace mdk {

/// The processor's name as the system gives it, or "unknown processor"; cores this process may use.
BenchMachine this_machine();

BenchProgram this_program(const std::string& commit);

}  // namespace mdk
