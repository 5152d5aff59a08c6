#include "preprocess/cli/failure.h"

#include <new>

#include "common/base/error.h"
#include "common/base/printable_text.h"
#include "preprocess/cli/interrupt.h"

namespace mdk {

Failure describe_failure(const std::exception_ptr& thrown) {
  constexpr const char* kPleaseReport = "internal fault, please report it: ";
  try {
    std::rethrow_exception(thrown);
  } catch (const Error& error) {
    return {error.exit_status(), printable_line(error.what())};
  } catch (const Interrupted& interrupted) {
    return {interrupted.exit_status(), "interrupted; no file was left half-written"};
  } catch (const std::bad_alloc&) {
    return {static_cast<int>(ErrorCode::kOverLimit),
            "not enough memory, the machine's or what --memory-limit allows; allow more, or try a "
            "smaller input, fewer clips or a smaller picture"};
  } catch (const std::exception& fault) {
    return {static_cast<int>(ErrorCode::kInternal), std::string(kPleaseReport) + fault.what()};
  } catch (...) {
    return {static_cast<int>(ErrorCode::kInternal), std::string(kPleaseReport) + "unknown"};
  }
}

}  // namespace mdk
