// A mapped file that another program cuts short, or whose disk fails, while it is in use.
#pragma once

namespace mdk {

/// From now on, touching a mapped part of a file that is no longer there ends the process with
/// status 4 and one sentence on stderr that names the program and the file; the system's own end is
/// a bus error without a word. For main: it counts for the whole process. Other bus errors end it
/// as ever.
void name_lost_mappings();

}  // namespace mdk
