// Trajectories as crowd scientists exchange them: "id frame x y [z]" a line, in metres, x and y on
// the ground. Each id becomes an instance on a path; where it looks and how fast its clip runs
// follow from where it goes.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <string_view>
#include <unordered_map>

#include "formats/files/mapped_file.h"
#include "formats/files/text.h"
#include "preprocess/casts/cast.h"

namespace mdk {
namespace {

constexpr double kTolerance = 0.002;     // metres: keys on a straight line are left out
constexpr double kTurnTolerance = 0.02;  // radians, likewise
constexpr double kLookSeconds = 0.4;     // how far ahead and back a heading is taken over
constexpr double kStandingSpeed = 0.1;   // metres a second: slower ones keep their heading
constexpr double kWalkingSpeed = 1.3;    // of a clip whose own speed is not known

struct Sample {
  double frame;
  Vec3d at;  ///< x and y on the ground, z up
  CastPlace place;
};

struct Track {
  std::int64_t id = 0;
  std::vector<Sample> samples;
};

struct Word {
  std::string_view text;
  CastPlace place;
};

class Reader {
 public:
  Reader(const std::string& file, const CastOptions& options, SceneBuilder& scene,
         std::vector<std::string>& notes)
      : file_(file), options_(options), scene_(scene), notes_(notes) {}

  void read(std::string_view text) {
    std::uint64_t line = 0;
    while (!text.empty()) {
      ++line;
      const std::size_t end = text.find('\n');
      std::string_view content = text.substr(0, end);
      text.remove_prefix(end == text.npos ? text.size() : end + 1);
      if (content.ends_with('\r')) content.remove_suffix(1);
      if (line == 1 && content.starts_with("\xef\xbb\xbf")) content.remove_prefix(3);
      read_line(content, line);
    }
    if (tracks_.empty()) throw cast_error(file_, {}, "holds no lines \"id frame x y\"");
    add_all();
  }

 private:
  [[noreturn]] void refuse(const CastPlace& place, const std::string& sentence) const {
    throw cast_error(file_, place, sentence);
  }

  /// Frame rate and unit, as programs of the field write them into comments.
  void read_comment(std::string_view comment) {
    if (const std::size_t at = comment.find("framerate"); at != comment.npos && !fps_) {
      std::string_view rest = comment.substr(at + 9);
      const std::size_t begin = rest.find_first_of("0123456789");
      if (begin != rest.npos) {
        rest.remove_prefix(begin);
        const std::size_t end = rest.find_first_not_of("0123456789.");
        if (const auto fps = parsed<double>(rest.substr(0, end)); fps && *fps > 0) fps_ = *fps;
      }
    }
    if (comment.find("x/cm") != comment.npos) unit_ = 0.01;
  }

  void read_line(std::string_view content, std::uint64_t line) {
    words_.clear();
    for (std::size_t at = 0; at < content.size();) {
      if (content[at] == '#') {
        read_comment(content.substr(at));
        break;
      }
      if (content[at] == ' ' || content[at] == '\t' || content[at] == ',') {
        ++at;
        continue;
      }
      const std::size_t end = std::min(content.find_first_of(" \t,#", at), content.size());
      words_.push_back({content.substr(at, end - at), {line, at + 1}});
      at = end;
    }
    if (words_.empty()) return;
    if (words_.size() < 4)
      refuse(words_.front().place,
             "has " + std::to_string(words_.size()) + " numbers, not \"id frame x y [z]\"");
    const auto id = parsed<std::int64_t>(words_[0].text);
    if (!id) refuse(words_[0].place, "the id must be a whole number, not " + word(0));
    Sample sample;
    sample.place = words_[0].place;
    sample.frame = number(1, "frame");
    const std::size_t columns = std::min<std::size_t>(words_.size(), 5);
    if (columns_ == 0) columns_ = words_.size();
    if (words_.size() != columns_)
      refuse(words_.front().place, "has " + std::to_string(words_.size()) + " numbers, not " +
                                       std::to_string(columns_) + " as the lines before");
    sample.at = {number(2, "x"), number(3, "y"), columns > 4 ? number(4, "z") : 0};
    const auto [found, is_new] = index_.try_emplace(*id, tracks_.size());
    if (is_new) tracks_.push_back({*id, {}});
    tracks_[found->second].samples.push_back(sample);
  }

  std::string word(std::size_t i) const { return mdk::quoted(words_[i].text); }
  double number(std::size_t i, const char* name) const {
    const auto value = parsed<double>(words_[i].text);
    if (!value || !(std::abs(*value) <= 1e15))
      refuse(words_[i].place, std::string("the ") + name + " must be a number, not " + word(i));
    return *value;
  }

  void add_all() {
    if (options_.models.empty())
      throw Error(ErrorCode::kUsage, file_ + ": trajectories name no models; give --model");
    const double fps = options_.fps ? *options_.fps : fps_.value_or(0);
    if (!(fps > 0))
      throw Error(ErrorCode::kUsage,
                  file_ + ": says no frame rate (\"# framerate: 25\"); give --fps");
    if (columns_ > 5) notes_.push_back(file_ + ": columns after z are left out");
    for (const std::string& path : options_.models) {
      models_.push_back(scene_.model(path));
      strides_.push_back(stride_of(models_.back()));
    }
    for (std::size_t t = 0; t < tracks_.size(); ++t) add_track(tracks_[t], t, fps);
  }

  double stride_of(std::uint32_t model) {
    if (options_.stride) return *options_.stride;
    const ModelView& view = scene_.view(model);
    std::uint32_t clip = 0;
    for (std::uint32_t c = 0; c < view.clips.size(); ++c)
      if (view.clips[c].name == options_.clip) clip = c;
    const std::string& name = scene_.model_path(model);
    if (const auto in_model = stride_speed(view, clip, options_.up)) {
      const double known = *in_model * options_.scale;
      notes_.push_back(name + ": the clip " + mdk::quoted(view.clips[clip].name) + " walks at " +
                       rounded(known) + " m/s, by its feet");
      return known;
    }
    notes_.push_back(name + ": its feet do not tell how fast it walks; taken as " +
                     rounded(kWalkingSpeed) + " m/s (--stride says better)");
    return kWalkingSpeed;
  }
  static std::string rounded(double value) {
    std::string text = std::to_string(value);
    return text.substr(0, text.find('.') + 3);
  }

  /// Directions of the way, smoothed, from sample to sample without jumps of a whole turn.
  static std::vector<double> headings(const std::vector<Sample>& samples, double fps) {
    std::vector<double> angles(samples.size());
    double last = 0;
    bool is_known = false;
    std::size_t first_known = samples.size(), back = 0, ahead = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      while (samples[i].frame - samples[back].frame > kLookSeconds * fps) ++back;
      while (ahead + 1 < samples.size() &&
             samples[ahead + 1].frame - samples[i].frame <= kLookSeconds * fps)
        ++ahead;
      const Vec3d way = samples[ahead].at - samples[back].at;
      const double seconds = (samples[ahead].frame - samples[back].frame) / fps;
      if (seconds > 0 && std::hypot(way.x, way.y) > kStandingSpeed * seconds) {
        double angle = std::atan2(way.y, way.x);
        if (is_known) angle = last + std::remainder(angle - last, 2 * std::numbers::pi);
        last = angle;
        if (!is_known) first_known = i;
        is_known = true;
      }
      angles[i] = last;
    }
    for (std::size_t i = 0; i < first_known && is_known; ++i) angles[i] = angles[first_known];
    return angles;
  }

  /// Leaves out samples that the ones kept give back within the tolerances.
  static std::vector<std::size_t> kept(const std::vector<Sample>& samples,
                                       const std::vector<double>& angles) {
    constexpr std::size_t kLongest = 256;
    std::vector<std::size_t> keep{0};
    const auto fits = [&](std::size_t a, std::size_t b) {
      if (std::abs(angles[b] - angles[a]) > 0.5) return false;
      for (std::size_t i = a + 1; i < b; ++i) {
        const double s =
            (samples[i].frame - samples[a].frame) / (samples[b].frame - samples[a].frame);
        const Vec3d off = samples[a].at + (samples[b].at - samples[a].at) * s - samples[i].at;
        if (length(off) > kTolerance ||
            std::abs(angles[a] + s * (angles[b] - angles[a]) - angles[i]) > kTurnTolerance)
          return false;
      }
      return true;
    };
    for (std::size_t at = 0; at + 1 < samples.size();) {
      std::size_t next = at + 1;
      while (next + 1 < samples.size() && next - at < kLongest && fits(at, next + 1)) ++next;
      keep.push_back(at = next);
    }
    return keep;
  }

  void add_track(Track& track, std::size_t number, double fps) {
    std::ranges::stable_sort(track.samples, {}, &Sample::frame);
    std::vector<Sample>& samples = track.samples;
    double way = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      samples[i].at = samples[i].at * unit_;
      if (i == 0) continue;
      if (samples[i].frame == samples[i - 1].frame)
        refuse(samples[i].place, "id " + std::to_string(track.id) + " is in this frame twice");
      const Vec3d step = samples[i].at - samples[i - 1].at;
      way += std::hypot(step.x, step.y);
    }
    const double seconds = (samples.back().frame - samples.front().frame) / fps;
    const std::vector<double> angles = headings(samples, fps);
    std::vector<PathKey> keys;
    for (const std::size_t i : kept(samples, angles)) {
      const Vec3d& p = samples[i].at;
      PathKey key;
      key.time = samples[i].frame / fps;
      // A model looks along +z where y is up, which is -y where z is.
      key.translation = to_float(options_.up == UpAxis::kY ? Vec3d{p.x, p.z, -p.y} : p);
      set_heading(angles[i] + std::numbers::pi / 2, options_.up, key.rotation);
      keys.push_back(key);
    }

    Actor actor;
    actor.model = models_[number % models_.size()];
    if (!options_.clip.empty()) actor.clip = options_.clip;
    actor.id = track.id;
    actor.map = upright_map({}, 0, options_.scale, options_.up);
    const double stride = strides_[number % models_.size()];
    actor.speed = seconds > 0 ? way / seconds / stride : 0;
    // Everyone is at another step; the golden ratio spreads them evenly.
    actor.start = std::fmod(static_cast<double>(number) * 0.6180339887498949, 1.0) * 10 -
                  actor.speed * keys.front().time;
    std::uint32_t path = 0;
    std::string fault = scene_.add_path(keys, PathEnds::kHide, path);
    actor.path = path;
    if (fault.empty()) fault = scene_.add(actor);
    if (!fault.empty()) refuse(samples.front().place, fault);
  }

  const std::string& file_;
  const CastOptions& options_;
  SceneBuilder& scene_;
  std::vector<std::string>& notes_;
  std::vector<Word> words_;
  std::size_t columns_ = 0;
  std::optional<double> fps_;
  double unit_ = 1;
  std::vector<Track> tracks_;  ///< in the order of their first lines
  std::unordered_map<std::int64_t, std::size_t> index_;
  std::vector<std::uint32_t> models_;
  std::vector<double> strides_;
};

}  // namespace

void read_trajectories(const std::string& file, const CastOptions& options, SceneBuilder& scene,
                       std::vector<std::string>& notes) {
  const MappedFile bytes(file);
  Reader(file, options, scene, notes)
      .read({reinterpret_cast<const char*>(bytes.bytes().data()), bytes.bytes().size()});
}

}  // namespace mdk
