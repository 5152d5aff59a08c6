// What every C function does: run C++ and turn what it throws into a status and a sentence.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstring>
#include <exception>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "mdk/error.h"
#include "mdk/mdk.h"
#include "mdk/model.h"
#include "mdk/ray_query.h"

/// A model and, once rays asked for it, what they go through.
struct mdk_model {
  explicit mdk_model(const mdk::Model& m) : model(m) {}

  const mdk::RayQuery& query() {
    std::call_once(once_, [&] { query_.emplace(model); });
    return *query_;
  }

  const mdk::Model model;
  std::atomic<std::size_t> users = 1;
  std::vector<std::string> clip_names;  ///< what mdk_clip_info points to

 private:
  std::once_flag once_;
  std::optional<mdk::RayQuery> query_;
};

namespace mdk::c {

/// The thread's sentence.
void set_last_error(const char* sentence) noexcept;

/// Runs `body`; what it throws becomes a status and the thread's last error.
template <class Body>
mdk_status call(Body&& body) noexcept {
  try {
    body();
    return MDK_OK;
  } catch (const Error& error) {
    set_last_error(error.what());
    return static_cast<mdk_status>(error.code());
  } catch (const std::bad_alloc&) {
    set_last_error("there is not enough memory");
    return MDK_ERROR_INTERNAL;
  } catch (const std::exception& error) {
    set_last_error(error.what());
    return MDK_ERROR_INTERNAL;
  } catch (...) {
    set_last_error("something unknown went wrong");
    return MDK_ERROR_INTERNAL;
  }
}

[[noreturn]] inline void refuse(const std::string& sentence) {
  throw Error(ErrorCode::kUsage, sentence);
}
/// Throws Error (kUsage) for a pointer that is null.
inline void require(const void* pointer, const char* name) {
  if (pointer == nullptr) refuse(std::string(name) + " is null");
}

/// A caller's struct in full: fields that a program of an older version does not have keep what
/// `Struct()` gives them. Throws Error (kUsage) for one without a size.
template <class Struct>
Struct read_struct(const Struct* given, const char* name) {
  require(given, name);
  Struct full{};
  const std::size_t size = given->struct_size;
  if (size < sizeof(std::size_t) || size > 16 * sizeof(Struct))
    refuse(std::string(name) + " has no struct_size: set it up by its init function");
  std::memcpy(&full, given, size < sizeof(Struct) ? size : sizeof(Struct));
  for (std::size_t i = sizeof(Struct); i < size; ++i)
    if (reinterpret_cast<const char*>(given)[i] != 0)
      refuse(std::string(name) + " asks for what this library is too old for");
  return full;
}
/// Writes as much of `full` as the caller's struct has.
template <class Struct>
void write_struct(const Struct& full, Struct* given, const char* name) {
  require(given, name);
  const std::size_t size = given->struct_size;
  if (size < sizeof(std::size_t) || size > 16 * sizeof(Struct))
    refuse(std::string(name) + " has no struct_size");
  std::memset(reinterpret_cast<char*>(given), 0, size);
  std::memcpy(reinterpret_cast<char*>(given), &full, size < sizeof(Struct) ? size : sizeof(Struct));
  given->struct_size = size;
}

inline ClipWrap wrap_of(mdk_wrap wrap) {
  if (wrap != MDK_WRAP_LOOP && wrap != MDK_WRAP_ONCE && wrap != MDK_WRAP_PING_PONG)
    refuse("wrap is " + std::to_string(wrap) + ": it must be one of mdk_wrap");
  return static_cast<ClipWrap>(wrap);
}

}  // namespace mdk::c
