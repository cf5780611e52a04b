#pragma once

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

/// Pages: what a comparison, a study, a verification or a validation has to say, as one self-contained HTML
/// file. Whoever has findings fills a Page with sentences, figures and tables; this room knows how they look.
///
/// Every figure and table has an `id`, unique in its page: the element's id, and the name under which its
/// data are offered as ID.csv and ID.json.
namespace flowrest::report {

/// No value: a gap in a curve, a dash in a table.
inline constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// What is drawn in the same way in every figure: a run, a solver, a model. Its warnings stand wherever its
/// name does.
struct Entry {
  std::string name = {};  ///< unique in the page
  int colour = 0;  ///< of a colour-blind safe palette of seven; -1 is ink, for what is exact or measured
  int dash = 0;    ///< solid, dashed, dotted, dash-dotted, ...: eight
  std::string doubt = {};    ///< "noisy", "under-resolved" or both; empty where it is sound
  std::string why = {};      ///< it is in doubt
  std::string trouble = {};  ///< why it is incomplete; empty where it came to its end
};

/// A paragraph. Plain text: it is escaped, and no number is parted from its unit.
struct Text {
  enum class Style { plain, opening, soft, warning, small };
  std::string text = {};
  Style style = Style::plain;
};

/// A short answer under a short question; several in a row make the first screen. A line break begins a
/// paragraph.
struct Answer {
  std::string question = {}, text = {};
};

struct Axis {
  std::string name = {}, unit = {};  ///< the unit may be empty
  bool logarithmic = false;
  bool can_switch = false;  ///< offers the other scale beside the figure
  std::optional<double> from = {}, to = {};
};

/// Points in a plot, joined or not.
struct Curve {
  std::string name = {};  ///< of the legend; empty: the entry's
  int entry = -1;  ///< index in Page::entries, whose looks it takes and with which it is hidden; -1: none
  std::vector<double> x = {}, y = {};   ///< of equal length; a y that is not finite is a gap
  std::vector<std::string> hover = {};  ///< empty, or a text a point: the settings behind it
  int colour = -1, dash = 0;            ///< of a curve without an entry
  bool line = true;
  bool marks = false;
  std::optional<double> held_from =
      std::nullopt;                         ///< x from which the value only stands: drawn as a thin tail
  std::vector<double> low = {}, high = {};  ///< empty, or the interval of each y, drawn as a bar
};

struct Plot {
  std::string id = {}, title = {}, caption = {};
  Axis x = {}, y = {};
  std::vector<Curve> curves = {};
  bool tall = false;
  /// y from which the axis starts unless the whole range is asked for; offers "whole range" beside the
  /// figure.
  std::optional<double> focus = std::nullopt;
};

/// Horizontal bars: a value of each group for each category.
struct Bars {
  struct Group {
    std::string name = {};
    std::vector<double> values = {};  ///< one a category
  };
  std::string id = {}, title = {}, caption = {};
  Axis x = {};
  std::vector<std::string> categories = {};
  std::vector<Group> groups = {};
  bool stacked = false;  ///< parts of a whole, one beside the other; may be negative
};

/// Curves on a common grid that change with time: a slider and a play button.
struct Frames {
  struct Curve {
    int entry = -1;
    std::vector<std::vector<double>> values = {};  ///< frame, grid; an empty frame says nothing at that time
  };
  std::string id = {}, title = {}, caption = {};
  std::string clock = {};          ///< sliders of the same clock move together; empty: the page's
  std::vector<double> times = {};  ///< s, of the frames
  Axis grid = {}, value = {};
  std::vector<double> coordinate = {};  ///< of the grid
  std::vector<Curve> curves = {};
  bool upright = false;  ///< the grid is the vertical axis
};

/// Fields over a section, one panel a run, at the same times: particles as dots, cells as rectangles.
struct Section {
  struct Quantity {
    std::string name = {}, unit = {};
    double from = 0.0, to = 1.0;  ///< the range of the colours
    bool logarithmic = false;
  };
  /// A quantised state: values of 0 to 255 over the quantity's range.
  struct Frame {
    double time = 0.0;                          ///< s
    std::vector<std::uint16_t> x = {}, z = {};  ///< particles: over the section's extent
    std::vector<std::uint8_t> cover = {};       ///< cells: fraction of concrete
    std::vector<std::vector<std::uint8_t>> values =
        {};  ///< a quantity each; empty where the run does not have it
  };
  struct Panel {
    int entry = -1;
    std::string missing = {};  ///< why there is nothing to draw, and how to make it
    double size = 0.0;         ///< particles: diameter in the section's unit
    std::vector<std::uint16_t> west = {}, east = {}, bottom = {},
                               top = {};  ///< cells: their edges over the section's extent
    std::vector<Frame> frames = {};
  };
  std::string id = {}, title = {}, caption = {};
  std::string clock = {};
  Axis x = {}, z = {};             ///< with `from` and `to`
  std::vector<double> times = {};  ///< s, of the slider
  std::vector<Quantity> quantities = {};
  std::vector<Panel> panels = {};
  bool to_scale = false;  ///< z is never stretched: it is no height
};

/// How a number is written.
struct Format {
  enum class Kind { significant, fixed, signed_fixed };
  Kind kind = Kind::significant;
  int digits = 3;
};

struct Column {
  std::string name, unit = {};
  Format format = {};
  bool text = false;     ///< set flush left
  std::string key = {};  ///< its name in the files; empty: name and unit
};

/// A table that sorts by any column. Columns without a single value are left out.
struct Table {
  using Cell = std::variant<std::monostate, double, std::string>;
  struct Row {
    std::vector<Cell> cells = {};  ///< the first names the row
    int entry = -1;                ///< whose warnings the row carries
    std::string badge = {};        ///< a warning of its own
    std::string choice = {};       ///< which of the table's choices it belongs to
  };
  std::string id = {}, title = {}, caption = {};
  std::vector<Column> columns = {};
  std::vector<Row> rows = {};
  std::string choice =
      "";  ///< what is chosen: "Time"; rows of the chosen value only are shown, the last one first
};

/// A map of verdicts over two parameters.
struct Map {
  enum class Verdict { sound, refused, stopped, warning, wrong };
  struct Cell {
    std::size_t row = 0, column = 0;
    Verdict verdict = Verdict::sound;
    std::string text = {};   ///< a word in the cell
    std::string hover = {};  ///< the reason
  };
  std::string id = {}, title = {}, caption = {};
  std::string row_name = {}, column_name = {};
  std::vector<std::string> rows = {}, columns = {};
  std::vector<Cell> cells = {};
};

/// What is folded away: facts as pairs, or a text as it stands.
struct Details {
  std::string summary = {};
  std::vector<std::pair<std::string, std::string>> facts = {};
  std::string text = {};
};

using Block = std::variant<Text, Answer, Plot, Bars, Frames, Section, Table, Map, Details>;

struct Chapter {
  std::string id = {}, heading = {};
  std::vector<Block> blocks = {};
  int level = 2;  ///< 3: within the chapter before
};

struct Page {
  std::string kind = {};   ///< "comparison", "study", "validation", "verification"
  std::string title = {};  ///< the scene's or the study's; leads every figure's title
  std::vector<Entry> entries = {};
  std::vector<Block> words = {};     ///< first screen: what was found
  std::optional<Block> figure = {};  ///< first screen: the one figure
  std::vector<Chapter> chapters = {};
  nlohmann::ordered_json data = {};        ///< offered as KIND.json
  nlohmann::ordered_json provenance = {};  ///< runs::provenance()
};

/// The page as HTML that needs no network.
/// @throws runs::MissingProgram where Chart.js is not installed; std::logic_error where an id is used twice
/// or lists of one figure differ in length.
std::string render(const Page&);

}  // namespace flowrest::report
