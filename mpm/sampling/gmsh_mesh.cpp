#include "mpm/sampling/gmsh_mesh.h"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>
#include <unordered_map>

#include "runs/process.h"
#include "runs/run_directory.h"
#include "runs/temporary_folder.h"

namespace flowrest::mpm {

namespace fs = std::filesystem;

namespace {

using Point = std::array<double, 3>;

/// Edges that give elements of volume 1 on average. Triangles come out nearly equilateral; tetrahedra do not
/// fill space, and those of a Delaunay mesh were measured: 0.194 edge^3 in a quarter of Abrams' cone.
const double edge_of_unit_triangle = std::sqrt(4.0 / std::sqrt(3.0));
const double edge_of_unit_tetrahedron = std::cbrt(1.0 / 0.194);

void write_geometry(const fs::path& file, const MeshedBody& body, double edge) {
  std::ofstream out(file);
  out << "SetFactory(\"OpenCASCADE\");\n";
  const std::size_t corners = body.outline.size();
  std::string loop;
  for (std::size_t i = 0; i < corners; ++i) {
    const auto& [along, up] = body.outline[i];
    if (body.dimension == 2) {
      fmt::print(out, "Point({}) = {{{:.17g}, {:.17g}, 0}};\n", i + 1, along, up);
    } else {
      fmt::print(out, "Point({}) = {{{:.17g}, {:.17g}, {:.17g}}};\n", i + 1, along,
                 body.turn > 0.0 ? 0.0 : body.lower, up);
    }
    loop += fmt::format("{}{}", i == 0 ? "" : ", ", i + 1);
  }
  for (std::size_t i = 0; i < corners; ++i)
    fmt::print(out, "Line({}) = {{{}, {}}};\n", i + 1, i + 1, (i + 1) % corners + 1);
  fmt::print(out, "Curve Loop(1) = {{{}}};\nPlane Surface(1) = {{1}};\n", loop);
  if (body.dimension == 3 && body.turn > 0.0) {
    fmt::print(out, "Extrude {{{{0, 0, 1}}, {{0, 0, 0}}, {:.17g}}} {{ Surface{{1}}; }}\n", body.turn);
  } else if (body.dimension == 3) {
    fmt::print(out, "Extrude {{0, {:.17g}, 0}} {{ Surface{{1}}; }}\n", body.upper - body.lower);
  }
  fmt::print(out, "Mesh.MeshSizeMin = {0:.17g};\nMesh.MeshSizeMax = {0:.17g};\n", edge);
}

Point operator-(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

MeshElement element(const std::vector<Point>& corners) {
  MeshElement e;
  e.lower = e.upper = corners.front();
  for (const Point& c : corners)
    for (std::size_t a = 0; a < 3; ++a) {
      e.centroid[a] += c[a] / static_cast<double>(corners.size());
      e.lower[a] = std::min(e.lower[a], c[a]);
      e.upper[a] = std::max(e.upper[a], c[a]);
    }
  const Point normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
  if (corners.size() == 3) {
    e.size = 0.5 * std::hypot(normal[0], normal[1], normal[2]);
  } else {
    const Point up = corners[3] - corners[0];
    e.size = std::abs(normal[0] * up[0] + normal[1] * up[1] + normal[2] * up[2]) / 6.0;
  }
  return e;
}

double edge_of(int dimension, double size) {
  return dimension == 2 ? edge_of_unit_triangle * std::sqrt(size)
                        : edge_of_unit_tetrahedron * std::cbrt(size);
}

/// A body's measures as its outline gives them.
struct Extent {
  double size = 0.0;  ///< m2 or m3
  Point lower{}, upper{};
  /// What straight edges may cut off a round side: of the volume, m3, and of the reach, m.
  double size_cut = 0.0, reach_cut = 0.0;
};

Extent extent_of(const MeshedBody& body, double edge) {
  Extent extent;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double low_along = infinity, high_along = -infinity, low_up = infinity, high_up = -infinity;
  double area = 0.0, moment = 0.0;  // of the area about the vertical axis
  for (std::size_t i = 0; i < body.outline.size(); ++i) {
    const auto& [x, z] = body.outline[i];
    const auto& [next_x, next_z] = body.outline[(i + 1) % body.outline.size()];
    area += 0.5 * (x * next_z - next_x * z);
    moment += (x + next_x) * (x * next_z - next_x * z) / 6.0;
    low_along = std::min(low_along, x);
    high_along = std::max(high_along, x);
    low_up = std::min(low_up, z);
    high_up = std::max(high_up, z);
  }
  if (body.dimension == 2) {
    extent.size = std::abs(area);
    extent.lower = {low_along, low_up, 0.0};
    extent.upper = {high_along, high_up, 0.0};
  } else if (body.turn == 0.0) {
    extent.size = std::abs(area) * (body.upper - body.lower);
    extent.lower = {low_along, body.lower, low_up};
    extent.upper = {high_along, body.upper, high_up};
  } else {
    // Pappus. An edge over an arc of the angle a cuts off a^2 / 6 of its sector, and a^2 / 8 of its radius.
    // Edges along a curve come out longer than what is asked, but no quarter is spanned by less than one.
    extent.size = std::abs(moment) * body.turn;
    const bool whole = body.turn > std::numbers::pi;
    extent.lower = {whole ? -high_along : 0.0, whole ? -high_along : 0.0, low_up};
    extent.upper = {high_along, high_along, high_up};
    const double chord = std::min(2.0 * edge, std::numbers::sqrt2 * high_along);
    extent.size_cut = std::min(0.5 * extent.size, 0.5 * body.turn * chord * chord / 6.0 * (high_up - low_up));
    extent.reach_cut = std::min(0.3 * high_along, chord * chord / (8.0 * high_along));
  }
  return extent;
}

}  // namespace

std::string misfit(const MeshedBody& body, const std::vector<MeshElement>& elements, double size) {
  const Extent wanted = extent_of(body, edge_of(body.dimension, size));
  double total = 0.0;
  Point lower = elements.front().lower, upper = elements.front().upper;
  for (const MeshElement& e : elements) {
    total += e.size;
    for (std::size_t a = 0; a < 3; ++a) {
      lower[a] = std::min(lower[a], e.lower[a]);
      upper[a] = std::max(upper[a], e.upper[a]);
    }
  }
  constexpr double round_off = 1e-6;
  if (!(total <= wanted.size * (1.0 + round_off) &&
        total >= wanted.size * (1.0 - round_off) - wanted.size_cut))
    return fmt::format("it fills {:.6g} {}, the body {:.6g}", total, body.dimension == 2 ? "m2" : "m3",
                       wanted.size);
  double longest = 0.0;
  for (std::size_t a = 0; a < 3; ++a) longest = std::max(longest, wanted.upper[a] - wanted.lower[a]);
  const double slip = round_off * longest;
  for (std::size_t a = 0; a < static_cast<std::size_t>(body.dimension); ++a) {
    const bool round = a < 2;  // the height is not cut
    const double cut = slip + (round ? wanted.reach_cut : 0.0);
    if (!(lower[a] >= wanted.lower[a] - slip && lower[a] <= wanted.lower[a] + cut &&
          upper[a] <= wanted.upper[a] + slip && upper[a] >= wanted.upper[a] - cut))
      return fmt::format("along axis {} it reaches from {:.6g} to {:.6g} m, the body from {:.6g} to {:.6g}",
                         a + 1, lower[a], upper[a], wanted.lower[a], wanted.upper[a]);
  }
  constexpr double coarsest = 2.0;
  const double mean = total / static_cast<double>(elements.size());
  if (mean > coarsest * size)
    return fmt::format("it has {} elements of {:.3g} {} on average, asked for were {:.3g}", elements.size(),
                       mean, body.dimension == 2 ? "m2" : "m3", size);
  return "";
}

std::vector<MeshElement> read_gmsh(const fs::path& file, int dimension) {
  const auto refuse = [&](const std::string& what) -> void {
    throw runs::RunError(
        fmt::format("{}: {}; expected is a mesh in Gmsh's format 2.2, ASCII", file.string(), what));
  };
  const int wanted = dimension == 2 ? 2 : 4;  // Gmsh's numbers of the triangle and the tetrahedron
  const std::size_t corners = dimension == 2 ? 3 : 4;
  std::ifstream in(file);
  std::unordered_map<long, Point> nodes;
  std::vector<MeshElement> elements;
  bool format = false, closed = false;
  for (std::string section; in >> section;) {
    if (section == "$MeshFormat") {
      double version = 0.0;
      int binary = 1;
      in >> version >> binary;
      if (!in || version < 2.0 || version >= 3.0 || binary != 0) refuse("another format");
      format = true;
    } else if (section == "$Nodes") {
      std::size_t count = 0;
      in >> count;
      for (std::size_t i = 0; i < count && in; ++i) {
        long id = 0;
        Point x{};
        in >> id >> x[0] >> x[1] >> x[2];
        nodes[id] = x;
      }
    } else if (section == "$Elements") {
      std::size_t count = 0;
      in >> count;
      std::string line;
      std::getline(in, line);
      for (std::size_t i = 0; i < count && std::getline(in, line); ++i) {
        std::istringstream words(line);
        int id = 0, type = 0, tags = 0, ignored = 0;
        words >> id >> type >> tags;
        if (type != wanted) continue;
        for (int t = 0; t < tags; ++t) words >> ignored;
        std::vector<Point> places;
        for (long node = 0; places.size() < corners && words >> node;) {
          const auto found = nodes.find(node);
          if (found == nodes.end()) refuse(fmt::format("an element with the unknown node {}", node));
          places.push_back(found->second);
        }
        if (places.size() < corners) refuse("an element with too few nodes");
        elements.push_back(element(places));
      }
    } else if (section == "$EndElements") {
      closed = true;
    }
  }
  if (!format || !closed) refuse("cut short");
  return elements;
}

std::vector<MeshElement> mesh_by_gmsh(const MeshedBody& body, double size) {
  const auto program = runs::find_program("gmsh");
  if (!program)
    throw runs::MissingProgram(
        "gmsh is not on the PATH: mpm.seeding = \"gmsh\" needs it (Debian: apt-get install gmsh); lattice "
        "and "
        "jittered do without");
  const runs::TemporaryFolder folder;
  write_geometry(folder / "body.geo", body, edge_of(body.dimension, size));
  // One thread, so that the same mesh comes out every time.
  runs::Process process(*program,
                        {"body.geo", fmt::format("-{}", body.dimension), "-format", "msh2", "-o", "body.msh",
                         "-nt", "1", "-v", "2"},
                        folder.path(), folder / "log", runs::Environment::of_helper());
  std::optional<runs::ProcessEnd> end;
  while (!(end = process.wait(0.1)))
    if (runs::InterruptGuard::count() > 0) throw runs::Interrupted("interrupted before the run began");
  if (!end->good())
    throw runs::RunError(
        fmt::format("gmsh failed ({}) on the body: {}", end->how(), runs::last_words(folder / "log")));
  auto elements = read_gmsh(folder / "body.msh", body.dimension);
  if (elements.empty())
    throw runs::RunError("gmsh made no mesh of the body: " + runs::last_words(folder / "log"));
  if (const std::string wrong = misfit(body, elements, size); !wrong.empty())
    throw runs::RunError(
        fmt::format("gmsh's mesh ({}) is not one of the body: {}", program->string(), wrong));
  return elements;
}

}  // namespace flowrest::mpm
