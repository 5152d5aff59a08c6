// What 'mdprep bench --rays' found, as a table and as JSON (mdk-rays/1).
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>

#include "preprocess/bench/rays.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

using Json = nlohmann::ordered_json;

std::string digits(double value, int places) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", places, value);
  return text;
}
std::string mebibytes(std::size_t bytes) {
  return digits(static_cast<double>(bytes) / (1 << 20), 1);
}

}  // namespace

std::string rays_json(const std::vector<RayBench>& models) {
  Json list = Json::array();
  for (const RayBench& model : models) {
    Json rows = Json::array();
    for (const RayBenchRow& row : model.rows) {
      Json item{{"row", row.row}, {"threads", row.threads}, {"ours_ns", row.ours_ns}};
      if (!model.peer.empty()) {
        item["peer"] = model.peer;
        item["peer_ns"] = row.peer_ns;
        item["plain_ns"] = row.plain_ns;
        item["ratio"] = std::round(row.ratio() * 1000) / 1000;
      }
      item["ours_bytes"] = row.ours_bytes;
      if (!model.peer.empty()) item["peer_bytes"] = row.peer_bytes;
      item["ours_build_ms"] = row.ours_build_ms;
      if (!model.peer.empty()) item["peer_build_ms"] = row.peer_build_ms;
      item["hits"] = row.hits;
      item["judged"] = row.judged;
      item["mismatches"] = row.mismatches;
      if (!model.peer.empty()) item["peer_differs"] = row.peer_differs;
      rows.push_back(std::move(item));
    }
    Json item{{"file", std::filesystem::path(model.file).filename().string()},
              {"isa", model.isa},
              {"triangles", model.triangles},
              {"keys", model.keys},
              {"rays", model.rays}};
    if (model.instances > 0) item["instances"] = model.instances;
    item["rows"] = std::move(rows);
    list.push_back(std::move(item));
  }
  return Json{{"schema", "mdk-rays/1"}, {"models", std::move(list)}}.dump(1) + "\n";
}

void print_rays(std::ostream& out, const std::vector<RayBench>& models) {
  TextTable table(2);
  table.add_row({"model", "rays", "threads", "hit %", "ns", "peer ns", "plain ns", "ratio", "MiB",
                 "peer MiB", "build ms", "peer build ms", "mismatches"});
  for (const RayBench& model : models)
    for (const RayBenchRow& row : model.rows)
      table.add_row({std::filesystem::path(model.file).stem().string(), row.row,
                     std::to_string(row.threads), digits(100 * row.hits, 1), digits(row.ours_ns, 1),
                     digits(row.peer_ns, 1), digits(row.plain_ns, 1), digits(row.ratio(), 2),
                     mebibytes(row.ours_bytes), mebibytes(row.peer_bytes),
                     digits(row.ours_build_ms, 1), digits(row.peer_build_ms, 1),
                     std::to_string(row.mismatches)});
  table.print(out);
}

}  // namespace mdk
