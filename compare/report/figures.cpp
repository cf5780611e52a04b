#include "compare/report/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <utility>

#include "compare/report/page_json.h"
#include "compare/report/picture_size.h"
#include "runs/process.h"
#include "runs/progress.h"
#include "runs/run_directory.h"

namespace flowrest::report {

namespace fs = std::filesystem;

namespace {

/// As in page/base.js: Okabe and Ito's palette on white, and the dashes.
constexpr const char* colours[] = {"#0072b2", "#d55e00", "#009e73", "#b0508a",
                                   "#b87e00", "#3a97cf", "#6b5600"};
constexpr const char* dashes[] = {"solid", "(9,4)",   "(2.5,3)",        "(12,3,3,3)",
                                  "(6,2)", "(1.5,5)", "(14,4,2,4,2,4)", "(5,5)"};
constexpr std::array<std::array<int, 3>, 10> viridis = {{{0x44, 0x01, 0x54},
                                                         {0x48, 0x28, 0x78},
                                                         {0x3e, 0x49, 0x89},
                                                         {0x31, 0x68, 0x8e},
                                                         {0x26, 0x82, 0x8e},
                                                         {0x1f, 0x9e, 0x89},
                                                         {0x35, 0xb7, 0x79},
                                                         {0x6e, 0xce, 0x58},
                                                         {0xb5, 0xde, 0x2b},
                                                         {0xfd, 0xe7, 0x25}}};

std::string quoted(const std::string& text) {
  std::string safe = "'";
  for (const char c : text) {
    if (c == '\n') continue;
    safe += c == '\'' ? std::string("''") : std::string(1, c);
  }
  return safe + "'";
}

std::string colour_of(int index) {
  return index < 0 ? "#1b2430" : colours[static_cast<std::size_t>(index) % std::size(colours)];
}
std::string dash_of(int index) {
  return dashes[static_cast<std::size_t>(std::max(index, 0)) % std::size(dashes)];
}
std::string axis_name(const Axis& axis) {
  return axis.unit.empty() ? axis.name : fmt::format("{} ({})", axis.name, axis.unit);
}

std::string name_of(const Entry& entry) {
  return entry.name + (entry.doubt.empty() ? "" : fmt::format(" ({})", entry.doubt)) +
         (entry.trouble.empty() ? "" : " (incomplete)");
}

/// A figure that a script draws: the size of its SVG and how much larger its PNG is.
struct Drawn {
  std::string id;
  int width = 0, height = 0;
};
constexpr double png_scale = 2.2;

/// A gnuplot script under way: data blocks and the commands of each figure.
class Script {
 public:
  void line(const std::string& text) { text_ += text + '\n'; }
  /// A block of data; its name.
  std::string data(const std::string& rows) {
    const std::string name = fmt::format("$d{}", blocks_++);
    text_ += fmt::format("{} << EOD\n{}EOD\n", name, rows);
    return name;
  }
  void note(const Drawn& figure) { drawn_.push_back(figure); }
  const std::string& text() const { return text_; }
  const std::vector<Drawn>& drawn() const { return drawn_; }

 private:
  std::string text_;
  std::vector<Drawn> drawn_;
  int blocks_ = 0;
};

void reset(Script& script, const std::string& title) {
  script.line("reset");
  script.line("set border 3 lc rgb '#5a6675'; set tics nomirror; set grid lc rgb '#dce1e7' lw 0.6");
  script.line(
      "set key below center Left reverse maxcols 2 samplen 3.5 spacing 1.15 width 2; set xlabel offset "
      "0,0.3");
  if (!title.empty()) script.line(fmt::format("set title {}", quoted(title)));
}

void set_axis(Script& script, char which, const Axis& axis, bool logarithmic) {
  script.line(fmt::format("set {}label {}", which, quoted(axis_name(axis))));
  const auto end = [](const std::optional<double>& value) {
    return value ? fmt::format("{:.9g}", *value) : std::string("*");
  };
  const bool usable = !logarithmic || !axis.from || *axis.from > 0.0;
  script.line(fmt::format("set {}range [{}:{}]", which, usable ? end(axis.from) : "*", end(axis.to)));
  if (logarithmic) script.line(fmt::format("set logscale {}; set format {} '%g'", which, which));
}

/// Draws what `commands` says as ID.svg and as ID.png.
void draw(Script& script, const std::string& id, const std::string& commands, int width, int height) {
  script.note({id, width, height});
  script.line(
      fmt::format("set terminal svg noenhanced size {},{} font 'Liberation Sans,13' background rgb 'white'",
                  width, height));
  script.line(fmt::format("set output '{}.svg'\n{}\nset output", id, commands));
  script.line(
      fmt::format("set terminal pngcairo noenhanced size {},{} font 'Liberation Sans,13' fontscale 1.65 "
                  "linewidth 2.2 pointscale 2.2",
                  png_scale * width, png_scale * height));
  script.line(fmt::format("set output '{}.png'\n{}\nset output", id, commands));
}

std::string points(const Curve& curve, double from, double to, bool positive_x, bool positive_y) {
  std::string rows;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    if (curve.x[i] < from || curve.x[i] > to || (positive_x && curve.x[i] <= 0.0)) continue;
    if (!std::isfinite(curve.y[i]) || (positive_y && curve.y[i] <= 0.0)) {
      rows += '\n';
      continue;
    }
    rows += fmt::format("{:.7g} {:.7g}", curve.x[i], curve.y[i]);
    if (!curve.low.empty()) rows += fmt::format(" {:.7g} {:.7g}", curve.low[i], curve.high[i]);
    rows += '\n';
  }
  return rows;
}

bool has_points(const std::string& rows) { return rows.find_first_not_of('\n') != std::string::npos; }

void add_plot(Script& script, const Page& page, const Plot& plot) {
  reset(script, page.title + ": " + plot.title);
  Axis y = plot.y;
  if (plot.focus && !plot.y.logarithmic) y.from = plot.focus;
  set_axis(script, 'x', plot.x, plot.x.logarithmic);
  set_axis(script, 'y', y, plot.y.logarithmic);
  std::string items;
  const auto add = [&](const std::string& item) { items += (items.empty() ? "plot " : ", \\\n  ") + item; };
  for (const Curve& curve : plot.curves) {
    const Entry* entry = curve.entry >= 0 ? &page.entries[static_cast<std::size_t>(curve.entry)] : nullptr;
    const int colour = entry ? entry->colour : curve.colour, dash = entry ? entry->dash : curve.dash;
    const std::string name = curve.name.empty() && entry ? name_of(*entry) : curve.name;
    constexpr double all = std::numeric_limits<double>::infinity();
    const std::string rows =
        points(curve, -all, curve.held_from.value_or(all), plot.x.logarithmic, plot.y.logarithmic);
    if (!has_points(rows)) continue;
    const std::string data = script.data(rows), looks = fmt::format("lc rgb '{}'", colour_of(colour));
    const std::string style =
        curve.line ? fmt::format("with {} {} dt {} lw 2 {}", curve.marks ? "linespoints" : "lines", looks,
                                 dash_of(dash), curve.marks ? "pt 7 ps 0.7" : "")
                   : fmt::format("with points {} pt 7 ps 0.8", looks);
    add(fmt::format("{} using 1:2 {} title {}", data, style, quoted(name)));
    if (!curve.low.empty()) add(fmt::format("{} using 1:2:3:4 with yerrorbars {} ps 0 notitle", data, looks));
    if (!curve.held_from) continue;
    const std::string tail = points(curve, *curve.held_from, all, plot.x.logarithmic, plot.y.logarithmic);
    if (has_points(tail))
      add(fmt::format("{} with lines {} dt (1,5) lw 1.5 notitle", script.data(tail), looks));
  }
  if (!items.empty()) draw(script, plot.id, items, 720, plot.tall ? 520 : 440);
}

void add_bars(Script& script, const Page& page, const Bars& bars) {
  reset(script, page.title + ": " + bars.title);
  const std::size_t count = bars.categories.size(), groups = bars.groups.size();
  double least = 1e300;
  for (const auto& group : bars.groups)
    for (const double v : group.values)
      if (v > 0.0) least = std::min(least, v);
  const double base = bars.x.logarithmic ? std::pow(10.0, std::floor(std::log10(least) - 0.3)) : 0.0;
  Axis x = bars.x;
  if (bars.x.logarithmic && !x.from) x.from = base;
  set_axis(script, 'x', x, bars.x.logarithmic);
  std::string names;
  for (std::size_t i = 0; i < count; ++i)
    names += fmt::format("{}{} {}", i > 0 ? ", " : "", quoted(bars.categories[i]), count - 1 - i);
  script.line(fmt::format(
      "set ytics ({}); set yrange [-0.6:{}]; unset grid; set grid x; set style fill solid 0.95 noborder",
      names, static_cast<double>(count) - 0.4));
  std::string items;
  std::vector<double> above(count, 0.0), below(count, 0.0);
  const double width = bars.stacked ? 0.66 : 0.72 / static_cast<double>(std::max<std::size_t>(groups, 1));
  for (std::size_t g = 0; g < groups; ++g) {
    std::string rows;
    for (std::size_t i = 0; i < count; ++i) {
      const double v = bars.groups[g].values[i];
      if (!std::isfinite(v)) continue;
      double& start = v < 0.0 ? below[i] : above[i];
      const double from = bars.stacked ? start : base;
      if (bars.stacked) start += v;
      const double y =
          static_cast<double>(count - 1 - i) +
          (bars.stacked ? 0.0 : (0.5 * static_cast<double>(groups - 1) - static_cast<double>(g)) * width);
      rows += fmt::format("{:.7g} {:.7g} {:.7g} {:.7g} {:.7g} {:.7g}\n", v, y, from, bars.stacked ? start : v,
                          y - 0.46 * width, y + 0.46 * width);
    }
    if (rows.empty()) continue;
    items += fmt::format("{}{} with boxxyerror lc rgb '{}' {}", items.empty() ? "plot " : ", \\\n  ",
                         script.data(rows), colour_of(static_cast<int>(g)),
                         groups > 1 ? "title " + quoted(bars.groups[g].name) : std::string("notitle"));
  }
  if (!items.empty())
    draw(script, bars.id, items, 720, 150 + static_cast<int>(34 * count * (bars.stacked ? 1 : groups)));
}

void add_frames(Script& script, const Page& page, const Frames& frames) {
  const std::size_t last = frames.times.size() - 1;
  reset(script, fmt::format("{}: {} at {:.3g} s", page.title, frames.title, frames.times[last]));
  set_axis(script, frames.upright ? 'y' : 'x', frames.grid, false);
  set_axis(script, frames.upright ? 'x' : 'y', frames.value, false);
  std::string items;
  for (const auto& curve : frames.curves) {
    const Entry& entry = page.entries[static_cast<std::size_t>(curve.entry)];
    const auto& values = curve.values[last];
    std::string rows;
    std::size_t end = values.size();
    while (!frames.upright && end > 1 && values[end - 1] == 0.0 && values[end - 2] == 0.0) --end;
    for (std::size_t i = 0; i < end; ++i)
      rows += frames.upright ? fmt::format("{:.7g} {:.7g}\n", values[i], frames.coordinate[i])
                             : fmt::format("{:.7g} {:.7g}\n", frames.coordinate[i], values[i]);
    if (rows.empty()) continue;
    items +=
        fmt::format("{}{} with lines lc rgb '{}' dt {} lw 2 title {}", items.empty() ? "plot " : ", \\\n  ",
                    script.data(rows), colour_of(entry.colour), dash_of(entry.dash), quoted(name_of(entry)));
  }
  if (!items.empty()) draw(script, frames.id, items, 720, 440);
}

/// 0xRRGGBB of a value of 0 to 255, laid over white by `cover`.
int shade(std::uint8_t value, double cover) {
  const double at = value / 255.0 * (viridis.size() - 1);
  const auto k = std::min<std::size_t>(viridis.size() - 2, static_cast<std::size_t>(at));
  int rgb = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double mixed = viridis[k][c] + (at - static_cast<double>(k)) * (viridis[k + 1][c] - viridis[k][c]);
    rgb = rgb << 8 | static_cast<int>(std::lround(255.0 + cover * (mixed - 255.0)));
  }
  return rgb;
}

double unpacked(std::uint16_t value, const Axis& axis) {
  return *axis.from + (*axis.to - *axis.from) * value / 65535.0;
}

const Section::Frame& frame_at(const Section::Panel& panel, double time) {
  return *std::min_element(panel.frames.begin(), panel.frames.end(), [time](const auto& a, const auto& b) {
    return std::abs(a.time - time) < std::abs(b.time - time);
  });
}

/// Rows of gnuplot's boxxyerror: centre, edges, colour.
std::string boxes(const Section& section, const Section::Panel& panel, const Section::Frame& frame) {
  const auto& values = frame.values.front();
  std::string rows;
  if (values.empty()) return rows;
  const bool cells = !panel.west.empty();
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (cells && frame.cover[i] < 3) continue;
    const double half = 0.5 * panel.size;
    const double x = cells ? 0.0 : unpacked(frame.x[i], section.x),
                 z = cells ? 0.0 : unpacked(frame.z[i], section.z);
    const double west = cells ? unpacked(panel.west[i], section.x) : x - half;
    const double east = cells ? unpacked(panel.east[i], section.x) : x + half;
    const double bottom = cells ? unpacked(panel.bottom[i], section.z) : z - half;
    const double top = cells ? unpacked(panel.top[i], section.z) : z + half;
    rows += fmt::format("{:.6g} {:.6g} {:.6g} {:.6g} {:.6g} {:.6g} {}\n", 0.5 * (west + east),
                        0.5 * (bottom + top), west, east, bottom, top,
                        shade(values[i], cells ? frame.cover[i] / 255.0 : 1.0));
  }
  return rows;
}

/// The height up to which a panel is drawn at a time: what the material reaches, and a fifth more.
double height_at(const Section& section, double time) {
  double top = *section.z.from;
  for (const auto& panel : section.panels) {
    if (panel.frames.empty()) continue;
    const auto& frame = frame_at(panel, time);
    if (panel.west.empty())
      for (const std::uint16_t z : frame.z) top = std::max(top, unpacked(z, section.z));
    else
      for (std::size_t i = 0; i < frame.cover.size(); ++i)
        if (frame.cover[i] > 127) top = std::max(top, unpacked(panel.top[i], section.z));
  }
  return std::min(*section.z.from + 1.2 * (top - *section.z.from), *section.z.to);
}

int panels_of(const Section& section) {
  return static_cast<int>(std::count_if(section.panels.begin(), section.panels.end(),
                                        [](const auto& p) { return !p.frames.empty(); }));
}

/// A run's name in two lines, solver above law.
std::string stacked_name(const Entry& entry) {
  const std::string name = name_of(entry);
  const auto space = name.find(' ');
  return space == std::string::npos
             ? quoted(name)
             : quoted(name.substr(0, space)) + ".\"\\n\"." + quoted(name.substr(space + 1));
}

/// The panels of a section at one time, plots inside a multiplot of `columns`. A panel's name stands over the
/// first row, its axes beside the first column and under the last row.
std::string panels_at(Script& script, const Page& page, const Section& section, double time, double height,
                      int columns, bool first, bool last) {
  const double step = std::pow(10.0, std::floor(std::log10(height - *section.z.from)));
  const double ticks = height - *section.z.from > 4.0 * step   ? 2.0 * step
                       : height - *section.z.from > 2.0 * step ? step
                                                               : 0.5 * step;
  std::string commands =
      fmt::format("set yrange [{:.6g}:{:.6g}]\nset ytics {:.6g}\n", *section.z.from, height, ticks);
  int nth = 0;
  const int count = panels_of(section);
  for (const auto& panel : section.panels) {
    if (panel.frames.empty()) continue;
    const auto& frame = frame_at(panel, time);
    const std::string rows = boxes(section, panel, frame);
    commands += first ? fmt::format("set title {} offset 0,-0.6\n",
                                    stacked_name(page.entries[static_cast<std::size_t>(panel.entry)]))
                      : std::string("unset title\n");
    const std::string beside = fmt::format("{:.3g} s", time);
    commands += nth % columns == 0
                    ? fmt::format("set ylabel {}.\"\\n\".{}\n", quoted(beside), quoted(axis_name(section.z)))
                    : std::string("unset ylabel\n");
    commands += last && nth + columns >= count ? fmt::format("set xlabel {}\n", quoted(axis_name(section.x)))
                                               : std::string("unset xlabel\n");
    commands +=
        rows.empty()
            ? std::string("plot NaN notitle\n")
            : fmt::format(
                  "plot {} using 1:2:3:4:5:6:7 with boxxyerror fs solid noborder lc rgb variable notitle, "
                  "NaN with points palette notitle\n",
                  script.data(rows));
    ++nth;
  }
  return commands;
}

/// How a section's plots look, and the key of its colours along the foot.
std::string section_style(const Section& section) {
  const auto& quantity = section.quantities.front();
  std::string palette;
  for (std::size_t i = 0; i < viridis.size(); ++i)
    palette += fmt::format("{}{} '#{:02x}{:02x}{:02x}'", i > 0 ? ", " : "", i, viridis[i][0], viridis[i][1],
                           viridis[i][2]);
  return fmt::format(
      "set palette defined ({})\nset cbrange [{:.6g}:{:.6g}]\n{}"
      "set colorbox horizontal user origin 0.25,0.085 size 0.5,0.018\nset cblabel {} offset 0,0.3\n"
      "set cbtics nomirror\nset xrange [{:.6g}:{:.6g}]\nset xtics 0,200\nunset key\nunset grid\n",
      palette, quantity.from, quantity.to,
      quantity.logarithmic ? "set logscale cb; set format cb '%g'\n" : "",
      quoted(quantity.name + (quantity.unit.empty() ? "" : " (" + quantity.unit + ")")), *section.x.from,
      *section.x.to);
}

void add_section(Script& script, const Page& page, const Section& section) {
  const int columns = panels_of(section);
  if (columns == 0) return;
  const std::size_t count = section.times.size();
  std::vector<double> times = {section.times[count / 4], section.times[count / 2], section.times[count - 1]};
  times.erase(std::unique(times.begin(), times.end()), times.end());
  reset(script, "");
  script.line(section_style(section));
  std::string rows;
  const int lines = static_cast<int>(times.size());
  for (int i = 0; i < lines; ++i) {
    const double time = times[static_cast<std::size_t>(i)];
    rows += panels_at(script, page, section, time, height_at(section, time), columns, i == 0, i + 1 == lines);
  }
  // Wide enough for the title, and beside the first column for the time and the axis.
  constexpr int narrowest = 720, beside = 80;
  const int width = std::max(narrowest, 230 * columns);
  const std::string commands = fmt::format(
      "set multiplot layout {},{} title {} margins {:.3f},0.985,0.24,0.84 spacing 0.045,0.07\n{}unset "
      "multiplot",
      lines, columns, quoted(page.title + ": " + section.title),
      std::max(0.09, static_cast<double>(beside) / width), rows);
  draw(script, section.id, commands, width, 180 + 150 * lines);
}

fs::path program_path(const std::string& name, const std::string& package) {
  const auto program = runs::find_program(name);
  if (!program)
    throw runs::MissingProgram(
        fmt::format("{} is not installed; get it by: apt-get install {}", name, package));
  return *program;
}

/// Runs a program in a folder, which it knows as the one it is in; its log stays where it fails.
void run_program(const std::string& name, const std::string& package,
                 const std::vector<std::string>& arguments, const fs::path& folder) {
  const fs::path program = program_path(name, package), log = folder / fmt::format("log.{}", name);
  runs::Process process(program, arguments, folder, log, runs::Environment::of_helper());
  const auto end = process.wait(600.0);
  if (end && end->good()) {
    fs::remove(log);
    return;
  }
  throw runs::RunError(fmt::format("{}: {} ended with {}; see {}", folder.string(), name,
                                   end ? end->how() : "a time-out", log.string()));
}

/// gnuplot without the settings of its user.
void run_gnuplot(const std::string& script, const fs::path& folder) {
  run_program("gnuplot", "gnuplot-nox", {"-d", script}, folder);
}

/// @throws runs::RunError where a picture is missing, not whole or of another size than asked for.
void check_picture(const std::string& program, const fs::path& file, double width, double height) {
  const auto size = file.extension() == ".svg" ? svg_size(file) : png_size(file);
  if (!size) throw runs::RunError(fmt::format("{}: {} left no whole picture", file.string(), program));
  constexpr double rounding = 1.0;
  if (std::abs((*size)[0] - width) > rounding || std::abs((*size)[1] - height) > rounding)
    throw runs::RunError(fmt::format("{}: {} drew {} x {} where {:g} x {:g} was asked for", file.string(),
                                     program, (*size)[0], (*size)[1], width, height));
}

/// Width, height and number of pictures of a film, as ffprobe reads them.
struct FilmSize {
  int width = 0, height = 0;
  std::size_t frames = 0;
};
FilmSize film_size(const std::string& film, const fs::path& folder) {
  const fs::path program = program_path("ffprobe", "ffmpeg"), said = folder / "film.txt";
  runs::Process process(
      program,
      {"-v", "error", "-count_packets", "-select_streams", "v:0", "-show_entries",
       "stream=width,height,nb_read_packets", "-of", "default=noprint_wrappers=1:nokey=1", film},
      folder, said, runs::Environment::of_helper());
  const auto end = process.wait(600.0);
  FilmSize size;
  if (end && end->good()) std::ifstream(said) >> size.width >> size.height >> size.frames;
  return size;
}

/// Pixels of a clip's pictures; video wants even sizes.
PictureSize clip_size(const Section& section) {
  const int panels = panels_of(section);
  return {100 + 360 * std::min(3, panels), 240 + 240 * ((panels + 2) / 3)};
}

/// gnuplot's commands for one picture of a clip: the panels in rows of three, the time beside them.
std::string clip_frame(const Page& page, const Section& section, std::size_t number, double top) {
  const int panels = panels_of(section), columns = std::min(3, panels), lines = (panels + 2) / 3;
  const auto [width, height] = clip_size(section);
  Script script;
  reset(script, "");
  script.line(section_style(section));
  const std::string plots = panels_at(script, page, section, section.times[number], top, columns, true, true);
  script.line(
      fmt::format("set terminal pngcairo noenhanced size {},{} font 'Liberation Sans,12'", width, height));
  script.line(fmt::format("set output '{:05}.png'", number));
  script.line(
      fmt::format("set multiplot layout {},{} title {} margins {:.3f},0.98,{:.3f},{:.3f} spacing "
                  "0.06,{:.3f}\n{}unset multiplot",
                  lines, columns, quoted(page.title), 90.0 / width, 155.0 / height, 1.0 - 90.0 / height,
                  75.0 / height, plots));
  return script.text();
}

}  // namespace

std::vector<std::string> write_figures(const Page& page, const fs::path& folder) {
  Script script;
  script.line("# Draws the figures of a flowrest report: gnuplot figures.gp");
  const auto add = [&](const Block& block) {
    if (const auto* plot = std::get_if<Plot>(&block))
      add_plot(script, page, *plot);
    else if (const auto* bars = std::get_if<Bars>(&block))
      add_bars(script, page, *bars);
    else if (const auto* frames = std::get_if<Frames>(&block))
      add_frames(script, page, *frames);
    else if (const auto* section = std::get_if<Section>(&block))
      add_section(script, page, *section);
  };
  if (page.figure) add(*page.figure);
  for (const Chapter& chapter : page.chapters)
    for (const Block& block : chapter.blocks) add(block);
  fs::create_directories(folder);
  runs::write_atomically(folder / "figures.gp", script.text());
  // What is there afterwards was drawn now.
  for (const Drawn& figure : script.drawn())
    for (const char* kind : {".svg", ".png"}) fs::remove(folder / (figure.id + kind));
  run_gnuplot("figures.gp", folder);
  std::vector<std::string> written;
  for (const Drawn& figure : script.drawn())
    for (const auto& [kind, scale] : {std::pair{".svg", 1.0}, {".png", png_scale}}) {
      check_picture("gnuplot", folder / (figure.id + kind), scale * figure.width, scale * figure.height);
      written.push_back(figure.id + kind);
    }
  return written;
}

void write_clip(const Page& page, const Section& section, const fs::path& file, bool quiet) {
  if (panels_of(section) == 0) throw runs::RunError("no run left states to make a clip of");
  program_path("ffmpeg", "ffmpeg");
  program_path("ffprobe", "ffmpeg");
  const fs::path folder = fs::absolute(file).parent_path() / (file.filename().string() + ".frames");
  fs::remove_all(folder);
  fs::create_directories(folder);
  const auto [width, height] = clip_size(section);
  runs::Progress progress("clip", static_cast<double>(section.times.size()), quiet);
  // The scale of heights follows the material but never jitters: it only ever shrinks.
  double top = *section.z.to;
  for (std::size_t i = 0; i < section.times.size(); ++i) {
    top = std::min(top, height_at(section, section.times[i]));
    runs::write_atomically(folder / "frame.gp", clip_frame(page, section, i, top));
    run_gnuplot("frame.gp", folder);
    check_picture("gnuplot", folder / fmt::format("{:05}.png", i), width, height);
    progress.update(static_cast<double>(i + 1), fmt::format("{:.3g} s", section.times[i]));
  }
  // Under a name that means nothing to ffmpeg, and only a whole film under its own.
  const bool gif = file.extension() == ".gif";
  const std::string film = gif ? "film.gif" : "film.webm";
  std::vector<std::string> arguments = {"-nostdin",   "-y", "-loglevel", "error",
                                        "-framerate", "12", "-i",        "%05d.png"};
  if (gif)
    arguments.insert(arguments.end(),
                     {"-vf", "split[a][b];[a]palettegen=max_colors=128[p];[b][p]paletteuse"});
  else
    arguments.insert(arguments.end(),
                     {"-c:v", "libvpx-vp9", "-crf", "32", "-b:v", "0", "-pix_fmt", "yuv420p"});
  arguments.push_back(film);
  run_program("ffmpeg", "ffmpeg", arguments, folder);
  const FilmSize made = film_size(film, folder);
  if (made.width != width || made.height != height || made.frames != section.times.size())
    throw runs::RunError(fmt::format(
        "{}: ffmpeg made a film of {} pictures of {} x {} where {} of {} x {} were asked for",
        (folder / film).string(), made.frames, made.width, made.height, section.times.size(), width, height));
  fs::rename(folder / film, file);
  fs::remove_all(folder);
  progress.finish(fmt::format("clip: {} ({} frames)", file.string(), section.times.size()));
}

}  // namespace flowrest::report
