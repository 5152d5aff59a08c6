// ViewState: what is open, what the user chose, and what the last frames said. The panels show and
// change it; the app makes pictures of it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "formats/mdk/mdk_file.h"
#include "viewer/scene/file_list.h"
#include "viewer/scene/scene_loader.h"
#include "viewer/state/camera.h"
#include "viewer/state/clusters.h"
#include "viewer/state/costs.h"
#include "viewer/state/layout.h"
#include "viewer/state/pick.h"
#include "viewer/state/playback.h"
#include "viewer/state/pose.h"
#include "viewer/state/settings.h"

namespace mdk {

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

  FrameCosts frames;
  CostCurves cost_curves;  ///< along the clip, from the current view
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
  const ModelView* shown_model() const {
    return clusters.part() ? &clusters.part()->model() : model();
  }
  const ModelView* model() const { return file ? &file->model() : nullptr; }
};

}  // namespace mdk
