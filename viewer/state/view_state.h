// ViewState: what is open, what the user chose, and what the last frames said. The panels show and
// change it; the app makes pictures of it.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/trace/frame_stats.h"
#include "common/trace/shading.h"
#include "formats/mdk_view.h"
#include "viewer/scene/file_choice.h"
#include "viewer/scene/scene_loader.h"
#include "viewer/state/cluster_view.h"
#include "viewer/state/color_scheme.h"
#include "viewer/state/compare.h"
#include "viewer/state/cost_curves.h"
#include "viewer/state/frame_history.h"
#include "viewer/state/hand_pose.h"
#include "viewer/state/layout.h"
#include "viewer/state/moment.h"
#include "viewer/state/orbit_camera.h"
#include "viewer/state/overlay_settings.h"
#include "viewer/state/panel_tab.h"
#include "viewer/state/pick.h"
#include "viewer/state/playback.h"

namespace mdk {

enum class Resolution {
  kFull,
  kHalf,
  kQuarter,
  kAuto,  ///< full, but coarser while a hand drags and full would be late
};

/// What the table of techniques shows.
enum class CostColumns { kTimes, kWork };

inline constexpr int kLeastTextPercent = 70, kMostTextPercent = 200;

struct ViewSettings {
  std::size_t technique = 0;  ///< row of technique_table()
  ShadingMode shading = ShadingMode::kDiffuse;
  std::uint32_t samples = 1;                      ///< per pixel
  std::uint32_t occlusion_rays = kOcclusionRays;  ///< per sample of lit pictures
  Resolution resolution = Resolution::kAuto;
  bool count_work = false;  ///< trace an extra counting frame now and then
  CostColumns cost_columns = CostColumns::kTimes;
  bool keep_tracing = false;  ///< trace again although nothing has changed, to watch the times
  ColorScheme colors = ColorScheme::kDark;
  int text_percent = 100;  ///< size of text and widgets; 100: as the display asks

  /// To another row of the table, around its ends.
  void step_technique(int by);
  void next_shading();
  /// Larger or smaller by so many steps, within bounds.
  void step_text_size(int by);

  bool operator==(const ViewSettings&) const = default;
};

enum class ExportKind { kPictures, kFilm };

struct ExportSettings {
  ExportKind kind = ExportKind::kPictures;
  bool films_possible = false;  ///< ffmpeg is there
};

/// The last picture shown and what it cost.
struct FrameReport {
  std::size_t technique = 0;
  std::uint32_t width = 0, height = 0;
  FrameStats stats;  ///< without counters
  std::size_t structure_bytes = 0;
  std::string note;  ///< what the technique chose, where it chooses
  HeatScale heat;    ///< of heat maps
  Camera camera;
  Moment moment;
};

/// What the last counting frame counted.
struct WorkReport {
  std::size_t technique = 0;
  std::uint64_t rays = 0;
  TraceCounters counters;
};

/// What a technique's latest frames of this file cost.
struct TechniqueCost {
  FrameReport frame;
  std::optional<WorkReport> work;  ///< where it was counted
};

struct ViewState {
  std::shared_ptr<const MdkFile> file;          ///< null: nothing is open
  std::string path;                             ///< of it, or of the source file it was baked from
  std::string file_name;                        ///< without its folders
  std::optional<SceneLoader::Progress> baking;  ///< of a source file, while that goes on
  ViewSettings settings;
  Playback playback;
  OrbitCamera camera;
  CompareSettings compare;
  ClusterView clusters;
  OverlaySettings overlays;
  std::optional<PickedTriangle> picked;
  ResidualCurveCache residuals;  ///< of the picked triangle
  bool turntable = false;        ///< the camera goes slowly round
  HandPose hand;                 ///< of a file with a skeleton; inactive for others

  std::optional<FrameReport> last_frame;
  std::optional<FrameReport> second_frame;      ///< of the technique it is compared with
  std::optional<PictureDifference> difference;  ///< between the two
  std::optional<WorkReport> last_work;
  std::map<std::size_t, TechniqueCost> costs;  ///< by row of technique_table()
  FrameHistory history;
  CostCurves cost_curves;  ///< along the clip, from the present view
  double shown_per_second = 0;

  std::vector<FileChoice> recent_files;  ///< newest first
  std::optional<FileMenu> file_menu;     ///< where it stands open
  ExportSettings export_settings;
  std::optional<MdprepProgress> exporting;  ///< while that goes on

  std::string error;   ///< the sentence that stands in the window, else empty
  std::string notice;  ///< a short-lived message, else empty
  PanelMode panel = PanelMode::kShown;
  PanelTab tab = PanelTab::kView;
  bool help_open = false;

  /// Whether the picture changes by itself as time passes.
  bool moves() const { return file && (playback.playing() || turntable); }
  /// The triangles that are in the picture; null: no file.
  const Model* shown_model() const { return clusters.part() ? &clusters.part()->model() : model(); }
  const Model* model() const { return file ? &file->model() : nullptr; }

  void note_frame(FrameReport frame);
  /// Of the technique the last one is compared with.
  void note_second_frame(FrameReport frame, const PictureDifference& difference);
  void note_work(const WorkReport& work);
  /// Another file is open: what frames of the last one cost counts no more.
  void forget_frames();
};

}  // namespace mdk
