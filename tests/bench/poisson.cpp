// Poisson surface reconstruction by CGAL, which ours is compared with (tests/bench/poisson.sh). No
// part of the product.
//
//   poisson POINTS SPACING RADIUS OUT.off
//
// POINTS: six doubles each, place and normal. SPACING: of the points. RADIUS: of the largest ball
// around a triangle, in SPACINGs; it sets the resolution.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/OFF.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/poisson_surface_reconstruction.h>
#include <CGAL/property_map.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <utility>
#include <vector>

typedef CGAL::Exact_predicates_inexact_constructions_kernel Kernel;
typedef std::pair<Kernel::Point_3, Kernel::Vector_3> Oriented;
typedef CGAL::Surface_mesh<Kernel::Point_3> Mesh;

int main(int argc, char **argv)
{
	std::vector<Oriented> points;
	Mesh mesh;
	double row[6];

	if (argc != 5) {
		std::fputs("usage: poisson POINTS SPACING RADIUS OUT.off\n", stderr);
		return 2;
	}
	std::FILE *file = std::fopen(argv[1], "rb");
	if (!file) {
		std::perror(argv[1]);
		return 1;
	}
	while (std::fread(row, sizeof(row), 1, file) == 1)
		points.push_back(Oriented(Kernel::Point_3(row[0], row[1], row[2]),
					  Kernel::Vector_3(row[3], row[4], row[5])));
	std::fclose(file);
	if (!CGAL::poisson_surface_reconstruction_delaunay(
		    points.begin(), points.end(), CGAL::First_of_pair_property_map<Oriented>(),
		    CGAL::Second_of_pair_property_map<Oriented>(), mesh,
		    std::strtod(argv[2], nullptr), 20, std::strtod(argv[3], nullptr), 0.375)) {
		std::fputs("no surface\n", stderr);
		return 1;
	}
	std::ofstream out(argv[4]);
	out.precision(12);
	return CGAL::IO::write_OFF(out, mesh) ? 0 : 1;
}
