// SourceFile: telling an animation that must be baked first from a file that can be viewed.
#pragma once

#include <string>

namespace mdk {

/// Throws Error (kBadInput) where the name is that of a format mdprep reads; the sentence gives the
/// command that makes an .mdk of it.
void refuse_source_file(const std::string& path);

}  // namespace mdk
