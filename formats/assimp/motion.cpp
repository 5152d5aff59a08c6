// Assimp's animations as glTF animations.
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "formats/assimp/import.h"
#include "formats/files/file_kind.h"

namespace mdk {
namespace {

constexpr double kTicksOfX = 4800;      // DirectX's own, where an .x file names none
constexpr double kTicksOfTheRest = 25;  // what Assimp's own programs take

/// A time and the numbers that hold then.
struct Key {
  double seconds = 0;
  std::vector<float> values;
};

struct Track {
  std::size_t node = 0;
  std::string path;  ///< "rotation"
  std::vector<Key> keys;

  const char* type() const {
    return path == "rotation" ? "VEC4" : path == "weights" ? "SCALAR" : "VEC3";
  }
};

class AnimationImport {
 public:
  AnimationImport(SceneImport& import, std::span<const std::size_t> target_counts)
      : import_(import), target_counts_(target_counts) {}

  void add(const aiAnimation& animation, std::size_t number) {
    place_ = "animation " + std::to_string(number);
    ticks_per_second_ = ticks_of(animation);
    tracks_.clear();
    for (unsigned c = 0; c < animation.mNumChannels; ++c) add_node(*animation.mChannels[c]);
    for (unsigned c = 0; c < animation.mNumMorphMeshChannels; ++c)
      add_weights(*animation.mMorphMeshChannels[c]);
    if (animation.mNumMeshChannels > 0)
      import_.note("meshes that an animation replaces as a whole are left out");
    if (!tracks_.empty()) write(animation.mName);
  }

 private:
  double ticks_of(const aiAnimation& animation) {
    if (std::isfinite(animation.mTicksPerSecond) && animation.mTicksPerSecond > 0)
      return animation.mTicksPerSecond;
    const bool is_x = lower_extension(import_.path) == ".x";
    const double ticks = is_x ? kTicksOfX : kTicksOfTheRest;
    import_.note("its animations name no ticks per second; " +
                 std::to_string(static_cast<int>(ticks)) + " are taken");
    return ticks;
  }

  double seconds_of(double ticks) const {
    const double seconds = ticks / ticks_per_second_;
    if (!std::isfinite(static_cast<float>(seconds)))
      import_.fail(place_ + " has a time that is not a finite number");
    return seconds;
  }

  template <class AssimpKey>
  std::vector<Key> vector_keys(const AssimpKey* from, unsigned count) const {
    std::vector<Key> keys;
    for (unsigned k = 0; k < count; ++k)
      keys.push_back(
          {seconds_of(from[k].mTime), {from[k].mValue.x, from[k].mValue.y, from[k].mValue.z}});
    return keys;
  }

  void add_node(const aiNodeAnim& channel) {
    const auto node = import_.node_numbers.find(channel.mNodeName.C_Str());
    if (node == import_.node_numbers.end())
      return import_.note("the node " + quoted_name(channel.mNodeName) +
                          " that an animation moves is not there");
    add_track(node->second, "translation",
              vector_keys(channel.mPositionKeys, channel.mNumPositionKeys));
    std::vector<Key> rotations;
    for (unsigned k = 0; k < channel.mNumRotationKeys; ++k) {
      const aiQuaternion& q = channel.mRotationKeys[k].mValue;
      rotations.push_back({seconds_of(channel.mRotationKeys[k].mTime), {q.x, q.y, q.z, q.w}});
    }
    add_track(node->second, "rotation", std::move(rotations));
    add_track(node->second, "scale", vector_keys(channel.mScalingKeys, channel.mNumScalingKeys));
  }

  /// The importers name a node, or a mesh, and some append "*" and a number.
  std::vector<std::size_t> nodes_of_morph(const aiString& name) const {
    const std::string whole(name.C_Str()), stem = whole.substr(0, whole.find('*'));
    for (const std::string& wanted : {whole, stem})
      if (const auto node = import_.node_numbers.find(wanted);
          node != import_.node_numbers.end() && target_counts_[node->second] > 0)
        return {node->second};
    std::vector<std::size_t> nodes;
    for (std::size_t n = 0; n < import_.nodes.size(); ++n) {
      bool shows = false;
      for (unsigned i = 0; i < import_.nodes[n]->mNumMeshes; ++i) {
        const std::string mesh = import_.scene.mMeshes[import_.nodes[n]->mMeshes[i]]->mName.C_Str();
        shows |= mesh == whole || mesh == stem;
      }
      if (shows && target_counts_[n] > 0) nodes.push_back(n);
    }
    return nodes;
  }

  void add_weights(const aiMeshMorphAnim& channel) {
    const std::vector<std::size_t> nodes = nodes_of_morph(channel.mName);
    if (nodes.empty())
      import_.note("the morph targets " + quoted_name(channel.mName) +
                   " that an animation moves are not there");
    for (const std::size_t node : nodes) {
      std::vector<Key> keys;
      for (unsigned k = 0; k < channel.mNumKeys; ++k) {
        const aiMeshMorphKey& from = channel.mKeys[k];
        Key key{seconds_of(from.mTime), std::vector<float>(target_counts_[node], 0.0f)};
        for (unsigned i = 0; i < from.mNumValuesAndWeights; ++i)
          if (from.mValues[i] < key.values.size())
            key.values[from.mValues[i]] = static_cast<float>(from.mWeights[i]);
        keys.push_back(std::move(key));
      }
      add_track(node, "weights", std::move(keys));
    }
  }

  void add_track(std::size_t node, const char* path, std::vector<Key> keys) {
    if (keys.empty()) return;
    for (const Key& key : keys)
      for (const float value : key.values)
        if (!std::isfinite(value))
          import_.fail(place_ + " has a " + path + " that is not a finite number");
    std::ranges::stable_sort(keys, {}, &Key::seconds);
    tracks_.push_back({node, path, std::move(keys)});
  }

  /// Importers give what does not move a single key at 0, which is not where the animation begins.
  void begin_constants_with_the_rest() {
    double start = std::numeric_limits<double>::infinity();
    for (const Track& track : tracks_)
      if (track.keys.size() > 1) start = std::min(start, track.keys.front().seconds);
    if (std::isinf(start)) return;
    for (Track& track : tracks_)
      if (track.keys.size() == 1) track.keys.front().seconds = start;
  }

  void write(const aiString& name) {
    begin_constants_with_the_rest();
    Json samplers = Json::array(), channels = Json::array();
    for (const Track& track : tracks_) {
      std::vector<float> times, values;
      for (const Key& key : track.keys) {
        times.push_back(static_cast<float>(key.seconds));
        values.insert(values.end(), key.values.begin(), key.values.end());
      }
      channels.push_back(
          {{"sampler", samplers.size()}, {"target", {{"node", track.node}, {"path", track.path}}}});
      samplers.push_back({{"input", import_.glb.add_floats("SCALAR", times)},
                          {"output", import_.glb.add_floats(track.type(), values)}});
    }
    Json out = {{"samplers", std::move(samplers)}, {"channels", std::move(channels)}};
    if (name.length > 0) out["name"] = name.C_Str();
    import_.glb.add("animations", std::move(out));
  }

  SceneImport& import_;
  std::span<const std::size_t> target_counts_;
  std::string place_;
  double ticks_per_second_ = kTicksOfTheRest;
  std::vector<Track> tracks_;
};

}  // namespace

void add_animations(SceneImport& import, std::span<const std::size_t> target_counts) {
  AnimationImport animations(import, target_counts);
  for (unsigned a = 0; a < import.scene.mNumAnimations; ++a)
    animations.add(*import.scene.mAnimations[a], a);
}

std::vector<char> moved_nodes(const SceneImport& import) {
  std::vector<char> moved(import.nodes.size(), 0);
  for (unsigned a = 0; a < import.scene.mNumAnimations; ++a) {
    const aiAnimation& animation = *import.scene.mAnimations[a];
    for (unsigned c = 0; c < animation.mNumChannels; ++c)
      if (const auto node = import.node_numbers.find(animation.mChannels[c]->mNodeName.C_Str());
          node != import.node_numbers.end())
        moved[node->second] = 1;
  }
  return moved;
}

}  // namespace mdk
