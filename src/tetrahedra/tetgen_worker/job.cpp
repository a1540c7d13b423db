#include "tetrahedra/tetgen_worker/job.h"

#include <tetgen.h>

#include <algorithm>
#include <string>

namespace {

// While the surface is recovered, its segments and facets are taken in their order instead of a random one:
// their tetrahedra are near to each other in memory then, which saves a third of the time.
bool in_order = false;
unsigned long asked = 0;            // for random numbers
constexpr unsigned most_ways = 64;  // of a walk, whose turns stay random: without that it may not end

}  // namespace

// In place of the definition in TetGen's shared library (as in terminate.cpp), with its generator.
unsigned long tetgenmesh::randomnation(unsigned int choices) {
  ++asked;
  if (in_order && choices > most_ways) return choices - 1;
  randomseed = (randomseed * 1366UL + 150889UL) % 714025UL;
  const unsigned long low = randomseed;
  if (choices < 714025U) return low % choices;
  randomseed = (randomseed * 1366UL + 150889UL) % 714025UL;
  return (low * (choices / 714025U) + randomseed) % choices;
}

namespace selvage::fem {
namespace {

// TetGen's form of the surface. Its arrays belong to tetgenio, which frees them with delete[].
void fill(const Job& job, tetgenio& in) {
  in.numberofpoints = static_cast<int>(job.points.size() / 3);
  in.pointlist = new REAL[job.points.size()];
  std::copy(job.points.begin(), job.points.end(), in.pointlist);
  in.numberoffacets = static_cast<int>(job.triangles.size() / 3);
  in.facetlist = new tetgenio::facet[static_cast<std::size_t>(in.numberoffacets)];
  for (int i = 0; i < in.numberoffacets; ++i) {
    tetgenio::facet& facet = in.facetlist[i];
    tetgenio::init(&facet);
    facet.numberofpolygons = 1;
    facet.polygonlist = new tetgenio::polygon[1];
    facet.polygonlist->numberofvertices = 3;
    facet.polygonlist->vertexlist = new int[3];
    std::copy_n(job.triangles.begin() + 3 * static_cast<std::ptrdiff_t>(i), 3, facet.polygonlist->vertexlist);
  }
}

tetgenbehavior behavior(const Job& job, std::string switches) {
  tetgenbehavior result;
  if (!result.parse_commandline(switches.data())) leave(Outcome::refused, 10);
  result.epsilon = job.settings.epsilon;
  return result;
}

}  // namespace

unsigned long random_numbers() {
  return asked;
}

// M: coplanar triangles stay triangles (their edges are wanted in the mesh). Q: quiet.
std::vector<std::int32_t> find_crossings(const Job& job) {
  tetgenbehavior settings = behavior(job, "pdMQ");
  tetgenio in, out;
  fill(job, in);
  ::tetrahedralize(&settings, &in, &out);
  if (out.trifacelist == nullptr) return {};
  return {out.trifacelist, out.trifacelist + 3 * static_cast<std::ptrdiff_t>(out.numberoftrifaces)};
}

// What ::tetrahedralize does with -pYM in TetGen 1.5, without its last steps, which restore the Delaunay
// property and optimize: points are put in by others.
void fill_surface(tetgenbehavior& settings, tetgenio& in, tetgenio& out) {
  tetgenmesh mesh;
  mesh.b = &settings;
  mesh.in = &in;
  clock_t time = 0;
  mesh.initializepools();
  mesh.transfernodes();
  exactinit(settings.verbose, settings.noexact, settings.nostaticfilter, mesh.xmax - mesh.xmin,
            mesh.ymax - mesh.ymin, mesh.zmax - mesh.zmin);
  mesh.incrementaldelaunay(time);
  mesh.meshsurface();
  in_order = true;
  mesh.recoverboundary(time);
  in_order = false;
  mesh.carveholes();
  mesh.suppresssteinerpoints();
  mesh.outnodes(&out);
  mesh.outelements(&out);
}

// Y: the surface stays as it is.
Tetrahedra tetrahedralize(const Job& job) {
  tetgenbehavior settings = behavior(job, "pYMQ");
  tetgenio in, out;
  fill(job, in);
  fill_surface(settings, in, out);
  Tetrahedra mesh;
  mesh.points.assign(out.pointlist, out.pointlist + 3 * static_cast<std::ptrdiff_t>(out.numberofpoints));
  mesh.cells.assign(out.tetrahedronlist,
                    out.tetrahedronlist + 4 * static_cast<std::ptrdiff_t>(out.numberoftetrahedra));
  return mesh;
}

}  // namespace selvage::fem
