// Which keys of the animation become frames, and what the frames' files are called.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace mdk {

/// The keys that "A:B", "A:B:S" or "A" means: from A to B, both included, every S-th. Key numbers
/// count through all clips. Throws Error (kUsage) where the text is something else, A lies past B,
/// or B is no key.
std::vector<std::uint32_t> parse_key_range(std::string_view text, std::uint32_t key_count);

/// min(wanted, key_count) keys spread evenly, the first and the last among them; rising.
std::vector<std::uint32_t> spread_keys(std::uint32_t wanted, std::uint32_t key_count);

/// Whether the file name (not its folder) has a run of '#'.
bool has_number_place(const std::string& pattern);

/// The last run of '#' in the file name becomes `number` with as many digits at least:
/// "out_####.png", 7 -> "out_0007.png". Without one: the pattern itself.
std::string numbered_path(const std::string& pattern, std::uint32_t number);

}  // namespace mdk
