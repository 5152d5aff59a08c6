// Of both programs: what mdk-assimp (main.cpp) tells the one that started it (reader.cpp), which is
// lines of text, then a .glb.
//
//     mdk-assimp 1
//     version 5.2.5
//     read walk.md5mesh
//     note points and lines are left out
//     glb
//     <bytes>
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace mdk {

inline constexpr const char* kAssimpProgram = "mdk-assimp";
inline constexpr std::uint64_t kMaxAssimpSeconds = 600;                   // of a core's work
inline constexpr std::uint64_t kMaxAssimpBytes = std::uint64_t{8} << 30;  // and no more than told

struct AssimpAnswer {
  std::string version;             ///< of Assimp
  std::vector<std::string> files;  ///< that were read
  std::vector<std::string> notes;
  std::vector<unsigned char> glb;
};

/// Throws Error (kIo).
void write_assimp_answer(const AssimpAnswer& answer, int file);

/// Throws Error (kInternal) where the bytes are no answer.
AssimpAnswer parse_assimp_answer(std::span<const unsigned char> bytes);

}  // namespace mdk
