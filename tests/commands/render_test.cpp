// mdprep render, started as a user does: are there pictures, and are they the same ones everywhere?
#include <gmock/gmock.h>
#include <png.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/base/isa.h"
#include "common/trace/shading.h"
#include "common/trace/technique.h"
#include "tests/commands/baked_sample.h"
#include "tests/commands/program_run.h"
#include "tests/commands/sample_mesh.h"

namespace mdk::test {
namespace {

using testing::HasSubstr;
using Json = nlohmann::json;

struct Picture {
  std::uint32_t width = 0, height = 0;
  std::vector<unsigned char> rgb;

  bool operator==(const Picture&) const = default;
  /// Pixels unlike the leftmost of their row, which shows background.
  std::size_t drawn_pixels() const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < rgb.size(); i += 3) {
      const std::size_t row = i / (3 * width) * (3 * width);
      count += std::memcmp(&rgb[i], &rgb[row], 3) != 0;
    }
    return count;
  }
};

Picture read_png(const std::string& path) {
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&image, path.c_str()) == 0) return {};
  image.format = PNG_FORMAT_RGB;
  Picture picture{image.width, image.height, std::vector<unsigned char>(PNG_IMAGE_SIZE(image))};
  if (png_image_finish_read(&image, nullptr, picture.rgb.data(), 0, nullptr) == 0) return {};
  return picture;
}

class Render : public BakedSample {
 protected:
  Outcome render(std::vector<std::string> options) const {
    options.insert(options.begin(), {"render", baked()});
    return run_mdprep(options);
  }
  /// One frame with these options.
  Picture picture(std::vector<std::string> options) const {
    options.insert(options.end(), {"-o", folder_.file("one.png"), "-q", "--size", "96x64"});
    const Outcome run = render(options);
    EXPECT_EQ(run.status, 0) << run.err;
    return read_png(folder_.file("one.png"));
  }
};

TEST_F(Render, MakesAPictureOfTheSizeThatWasAskedFor) {
  const Outcome run = render({"-o", folder_.file("a.png"), "--frames", "12", "--size", "200x120"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.out, "");
  const Picture image = read_png(folder_.file("a.png"));
  EXPECT_EQ(image.width, 200u);
  EXPECT_EQ(image.height, 120u);
  EXPECT_GT(image.drawn_pixels(), 200u * 120 / 50);
  EXPECT_LT(image.drawn_pixels(), 200u * 120);
}

TEST_F(Render, NumbersFramesByTheirKeys) {
  const Outcome run =
      render({"-o", folder_.file("f_###.png"), "--frames", "29:33:2", "--size", "16x16", "-q"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_EQ(folder_.names(), (std::vector<std::string>{"f_029.png", "f_031.png", "f_033.png"}));
}

TEST_F(Render, WithoutFramesRendersEveryKeyOfTheClip) {
  ASSERT_EQ(render({"-o", folder_.file("#.png"), "--clip", "swing", "--size", "8x8", "-q"}).status,
            0);
  EXPECT_EQ(folder_.names().size(), 16u);
  EXPECT_EQ(folder_.names().front(), "31.png");
}

TEST_F(Render, ATimeAtAKeyShowsThatKeyAndOneBetweenShowsNeither) {
  const Picture at_key = picture({"--frames", "35"});
  const Picture same = picture({"--clip", "swing", "--time", "0.13333333333333333"});
  const Picture between = picture({"--clip", "swing", "--time", "0.15"});
  EXPECT_TRUE(at_key == same);
  EXPECT_FALSE(at_key == between);
  EXPECT_FALSE(between == picture({"--frames", "36"}));
}

TEST_F(Render, ShowsTheSamePixelsWithEveryTechniqueOfOursThreadCountAndInstructionSet) {
  for (const std::vector<std::string>& moment :
       {std::vector<std::string>{"--frames", "20"}, {"--time", "0.7123"}}) {
    const Picture expected = picture(moment);
    ASSERT_GT(expected.drawn_pixels(), 100u);
    std::vector<std::vector<std::string>> ways = {{"--threads", "1"}, {"--threads", "2"}};
    for (const TechniqueInfo& technique : technique_table())
      if (technique.kind != TechniqueKind::kPeer)
        ways.push_back({"--technique", std::string(technique.id)});
    for (const std::string_view isa : available_isas())
      if (isa != "scalar") ways.push_back({"--isa", std::string(isa)});
    for (std::vector<std::string> way : ways) {
      const std::string name = way[0] + " " + way[1];
      way.insert(way.end(), moment.begin(), moment.end());
      EXPECT_TRUE(picture(way) == expected) << name;
    }
  }
}

TEST_F(Render, AFrameIsTheSameInAnyRange) {
  const auto frames = [&](const std::string& range, const std::string& name) {
    const Outcome run = render({"-o", folder_.file(name + "_##.png"), "--frames", range, "--size",
                                "64x48", "-q", "--technique", "fuzzy-bvh"});
    EXPECT_EQ(run.status, 0) << run.err;
  };
  frames("28:34", "long");  // the second clip starts at key 31
  frames("29:30", "a");
  frames("31:34:3", "b");
  for (const auto& [name, keys] : {std::pair("a", "29"), {"a", "30"}, {"b", "31"}, {"b", "34"}})
    EXPECT_TRUE(read_text(folder_.file(std::string(name) + "_" + keys + ".png")) ==
                read_text(folder_.file(std::string("long_") + keys + ".png")))
        << keys;
}

TEST_F(Render, EveryShadingIsTheSameOnAnyInstructionSetAndThreadCount) {
  for (const ShadingInfo& shading : shading_table()) {
    std::vector<std::string> options = {"--frames", "20", "--shading", std::string(shading.id)};
    const Picture expected = picture(options);
    for (const std::string_view isa : available_isas()) {
      if (isa == "scalar") continue;
      std::vector<std::string> with = options;
      with.insert(with.end(), {"--isa", std::string(isa), "--threads", "1"});
      EXPECT_TRUE(picture(with) == expected) << shading.id << " " << isa;
    }
  }
}

TEST_F(Render, AFilmHasEveryFrameAndTheSameBytesAgain) {
  if (std::system("command -v ffmpeg ffprobe > /dev/null") != 0)
    GTEST_SKIP() << "there is no ffmpeg";
  const auto film = [&](const std::string& name) {
    const Outcome run =
        render({"-o", folder_.file(name), "--frames", "0:9", "--size", "63x47", "-q"});
    EXPECT_EQ(run.status, 0) << run.err;
    return read_text(folder_.file(name));
  };
  EXPECT_TRUE(film("a.mp4") == film("b.mp4"));
  const std::string probe =
      "ffprobe -v error -count_frames -select_streams v -show_entries "
      "stream=nb_read_frames,r_frame_rate,width -of csv=p=0 '" +
      folder_.file("a.mp4") + "' > '" + folder_.file("probe") + "'";
  ASSERT_EQ(std::system(probe.c_str()), 0);
  EXPECT_EQ(read_text(folder_.file("probe")), "64,30/1,10\n");
}

TEST_F(Render, WithoutFfmpegAFilmIsRefusedInASentence) {
  const std::string line = "env PATH=/nowhere '" MDPREP_PATH "' render '" + baked() + "' -o '" +
                           folder_.file("a.mp4") + "' -q 2> '" + folder_.file("err") + "'";
  EXPECT_EQ(WEXITSTATUS(std::system(("/usr/bin/" + line).c_str())), 4);
  EXPECT_THAT(read_text(folder_.file("err")), HasSubstr("needs the program ffmpeg"));
  EXPECT_EQ(folder_.names(), std::vector<std::string>{"err"});
}

/// A program ffmpeg of our own that writes 200 KiB of messages before it reads a picture.
class RenderWithTalkativeFfmpeg : public Render {
 protected:
  Outcome film(const std::string& end_of_script) const {
    const TempFolder bin;
    write_text(bin.file("ffmpeg"),
               "#!/bin/sh\necho the first of many messages >&2\n"
               "head -c 204800 /dev/zero | tr '\\0' x >&2\n"
               "for last; do :; done\ncat > \"${last#file:}\"\n" +
                   end_of_script);
    std::filesystem::permissions(bin.file("ffmpeg"), std::filesystem::perms::owner_all);
    const std::string line = "PATH='" + bin.path() +
                             ":/usr/bin:/bin' timeout -s KILL 60 '" MDPREP_PATH "' render '" +
                             baked() + "' -o '" + folder_.file("a.mp4") +
                             "' --frames 0:9 --size 256x256 -q 2> '" + folder_.file("err") + "'";
    Outcome outcome;
    outcome.status = WEXITSTATUS(std::system(line.c_str()));
    outcome.err = read_text(folder_.file("err"));
    return outcome;
  }
};

TEST_F(RenderWithTalkativeFfmpeg, MessagesOfAnyLengthDoNotBlockAFilm) {
  const Outcome outcome = film("exit 0\n");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(read_text(folder_.file("a.mp4")).size(), 10u * 256 * 256 * 3);
}

TEST_F(RenderWithTalkativeFfmpeg, AFailureIsToldWithTheFirstOfThem) {
  const Outcome outcome = film("exit 1\n");
  EXPECT_EQ(outcome.status, 4);
  EXPECT_TRUE(is_one_sentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("(the first of many messages)"));
  EXPECT_EQ(folder_.names(), std::vector<std::string>{"err"});
}

TEST_F(Render, ShadingAndCameraChangeThePicture) {
  const Picture diffuse = picture({"--frames", "20"});
  EXPECT_FALSE(picture({"--frames", "20", "--shading", "normals"}) == diffuse);
  EXPECT_FALSE(picture({"--frames", "20", "--shading", "clusters"}) == diffuse);
  const Picture away = picture({"--frames", "20", "--camera", "0 1 5 0 1 9 0 1 0 45"});
  EXPECT_EQ(away.drawn_pixels(), 0u);
}

TEST_F(Render, EveryShadingModeHasAPictureOfItsOwn) {
  std::vector<Picture> pictures;
  for (const ShadingInfo& mode : shading_table()) {
    pictures.push_back(picture({"--frames", "20", "--shading", std::string(mode.id)}));
    for (std::size_t i = 0; i + 1 < pictures.size(); ++i)
      EXPECT_FALSE(pictures[i] == pictures.back()) << mode.id << " and " << shading_table()[i].id;
  }
}

TEST_F(Render, OneSampleIsThePictureWithoutTheOptionAndMoreAreAnother) {
  const Picture plain = picture({"--frames", "20"});
  EXPECT_TRUE(picture({"--frames", "20", "--samples", "1"}) == plain);
  const Picture smooth = picture({"--frames", "20", "--samples", "8"});
  EXPECT_FALSE(smooth == plain);
  EXPECT_FALSE(picture({"--frames", "20", "--samples", "8", "--shutter", "0.2"}) == smooth);
  EXPECT_FALSE(picture({"--frames", "20", "--shading", "lit", "--ao", "0"}) ==
               picture({"--frames", "20", "--shading", "lit"}));
}

TEST_F(Render, RefusesNumbersOfSamplesAndRaysThatCannotBe) {
  for (const std::vector<std::string>& words : {std::vector<std::string>{"--samples", "0"},
                                                {"--samples", "x"},
                                                {"--ao", "-1"},
                                                {"--ao", "100000"},
                                                {"--shutter", "-1"},
                                                {"--shutter", "soon"}}) {
    std::vector<std::string> arguments = {"-o", folder_.file("no.png"), "--frames", "1"};
    arguments.insert(arguments.end(), words.begin(), words.end());
    const Outcome run = render(arguments);
    EXPECT_EQ(run.status, 2) << words[0] << " " << words[1];
    EXPECT_NE(run.err.find(words[0]), std::string::npos) << run.err;
  }
}

TEST_F(Render, StatsSayWhatTheColoursOfAHeatMapMean) {
  const auto row = [&](const std::string& shading) {
    const Outcome run = render({"-o", folder_.file("h.png"), "--frames", "3", "--size", "64x64",
                                "--shading", shading, "--stats", folder_.file("h.json"), "-q"});
    EXPECT_EQ(run.status, 0) << run.err;
    return Json(Json::parse(read_text(folder_.file("h.json")))["frames"][0]);
  };
  EXPECT_GT(row("tests")["heat_scale"]["top"], 0);
  EXPECT_EQ(row("boxes")["heat_scale"]["unit"], "visits per ray");
  EXPECT_EQ(row("residual")["heat_scale"]["unit"], "% of the diagonal");
  EXPECT_FALSE(row("diffuse").contains("heat_scale"));
  EXPECT_GT(row("lit")["light_rays"], 0);
}

TEST_F(Render, StatsHaveARowPerFrameWithTimesAndCounts) {
  const Outcome run = render({"-o", folder_.file("#.png"), "--frames", "0:4:2", "--size", "64x48",
                              "--stats", folder_.file("stats.json"), "--threads", "2"});
  ASSERT_EQ(run.status, 0) << run.err;
  const Json stats = Json::parse(read_text(folder_.file("stats.json")));
  EXPECT_EQ(stats["schema"], "mdprep-render/1");
  EXPECT_EQ(stats["width"], 64);
  EXPECT_EQ(stats["height"], 48);
  EXPECT_EQ(stats["technique"], "fuzzy-bvh");
  EXPECT_EQ(stats["threads"], 2);
  ASSERT_EQ(stats["frames"].size(), 3u);
  for (int i = 0; i < 3; ++i) {
    const Json& row = stats["frames"][i];
    EXPECT_EQ(row["key"], 2 * i);
    EXPECT_EQ(row["clip"], "bend");
    EXPECT_EQ(row["rays"], 64 * 48);
    EXPECT_GT(row["hits"], 0);
    EXPECT_GT(row["node_visits_per_ray"], 0.0);
    EXPECT_GT(row["leaf_triangles_per_ray"], 0.0);
    EXPECT_GT(row["triangle_tests_per_ray"], 0.0);
    EXPECT_GT(row["clusters_per_ray"], 0.0);
    const double sum = row["pose_ms"].get<double>() + row["update_ms"].get<double>() +
                       row["trace_ms"].get<double>() + row["shade_ms"].get<double>();
    EXPECT_DOUBLE_EQ(row["time_to_image_ms"], sum);
    EXPECT_GT(sum, 0);
  }
}

}  // namespace
}  // namespace mdk::test
