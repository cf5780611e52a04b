#include "compare/apparatus/l_box.h"

#include <fmt/format.h>

#include <limits>

#include "compare/exact/channel.h"
#include "compare/exact/solution_run.h"
#include "compare/findings.h"
#include "runs/gauges.h"

namespace flowrest::compare {

using exact::ArrestedChannel;
using exact::Bingham;
using exact::ExactRun;
using exact::refuse;
using scenes::Scene;

namespace {

class LBoxReport : public ApparatusReport {
 public:
  LBoxReport() : ApparatusReport(scenes::LBox{}) {}

  /// Streaks of broken flocs trail behind its bars.
  bool seen_from_above() const override { return true; }

  std::optional<double> channel_length(const Scene& scene) const override {
    return scene.l_box().channel_length;
  }

  const Gauge& gauge() const override {
    static const Gauge gauge = millimetres(
        "front", "front_mm", "further", "shorter",
        "Front: the distance from the gate at which the depth falls through {depth:g} mm; it ends at the end "
        "wall. A thin dotted tail continues a run that has come to rest.");
    return gauge;
  }
  const std::vector<Gauge>& further_gauges() const override { return channel_gauges(); }
  const std::vector<Reading>& readings() const override {
    static const std::vector<Reading> all = {reading_named("front_mm"), reading_named("arrival_s"),
                                             reading_named("end_height_mm"), reading_named("rest_s")};
    return all;
  }

  std::string readings_sentence(const Comparison& comparison, const RunView& view) const override {
    return arrival_sentence(comparison, view, true);
  }

  std::vector<ExactRun> write_exact_runs(const Scene& scene, const std::filesystem::path& directory,
                                         std::optional<double> flocculation,
                                         runs::Replace replace) const override {
    const Bingham material = exact::material_of(scene, flocculation);
    const auto& box = scene.l_box();
    if (scene.base.law == scenes::Wall::slip)
      refuse(scene, "walls without friction hold nothing: the concrete levels out");
    if (!(material.yield_stress > 0.0)) refuse(scene, "without a yield stress the material levels out");
    if (!(scene.forces.gravity > 0.0)) refuse(scene, "without gravity nothing leaves the reservoir");
    const double friction = scene.base.law == scenes::Wall::friction
                                ? scene.base.friction
                                : std::numeric_limits<double>::infinity();
    const double volume = box.reservoir_length * box.width * box.reservoir_height;
    const ArrestedChannel shape(material, scene.forces.gravity, {box.width, box.length(), friction}, volume);
    if (shape.depth(box.reservoir_length) > box.channel_height)
      refuse(scene, fmt::format(
                        "it would fill the opening ({:.0f} mm), whose upper wall the solution does not have: "
                        "it stands at {:.0f} mm there",
                        1e3 * box.channel_height, 1e3 * shape.depth(box.reservoir_length)));
    const double front_depth = scene.gauges.front_depth;
    const double front = shape.reach(front_depth) - box.reservoir_length;
    const double end = shape.end_height(), start = shape.start_height();
    const std::string label =
        flocculation ? fmt::format("exact, arrested, flocculation {:g}", *flocculation) : "exact, arrested";
    runs::RunWriter writer = exact::open_run(directory / "arrested", scene, flocculation, replace);
    writer.info()["model"] = "bingham";
    writer.info()["label"] = label;
    writer.info()["source"] =
        "yield stress on floor and side walls against the weight (Nguyen, Roussel and Coussot 2006), no bars";
    writer.history(runs::Row()
                       .add(runs::column::time, scene.time.end)
                       .add(runs::column::front, front)
                       .add(runs::column::end_height, end)
                       .add(runs::column::start_height, start)
                       .add(runs::column::volume, volume));
    std::vector<double> coordinate = exact::points_to(shape.front()), depth;
    for (const double x : coordinate) depth.push_back(shape.depth(x));
    writer.profile(scene.time.end, coordinate, depth);
    writer.finish(runs::Status::at_rest, "the arrested shape, reached without inertia", "sound");
    const auto mm = [&](double length) { return runs::millimetres(length, front_depth); };
    return {{directory / "arrested",
             end > 0.0 ? fmt::format("{}: reaches the end, {} high there, {} at the start", label, mm(end),
                                     mm(start))
                       : fmt::format("{}: {}, {} high at the start", label,
                                     runs::shown_length("front", front, front_depth), mm(start))}};
  }
};

}  // namespace

const ApparatusReport& own_report(const scenes::LBox&) {
  static const LBoxReport report;
  return report;
}

}  // namespace flowrest::compare
