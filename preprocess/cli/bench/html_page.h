// A report as one HTML page that needs nothing else: no network, no script; light or dark as the
// reader's system has it.
#pragma once

#include <string>

#include "preprocess/cli/bench/report.h"

namespace mdk {

std::string html_page(const Report& report);

}  // namespace mdk
