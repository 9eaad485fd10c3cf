#pragma once
/// How many polynomials in the graded coordinate of mesh.hpp a motion needs. A guess to start from: solvers look at the last coefficients and add.
///
/// A wave of local number k(t) = w max(sqrt c, sqrt(kappa) c) J is resolved from degree K = max k sqrt(1 - t^2) on, the last digits about a cube root
/// of K later; a function with a singularity at x = i pi/2 at the rate at which its ellipse through there grows.
///
///     int n = functions_for(cable, 8);            // modes
///     int m = functions_up_to(cable, 12.5);       // motion at frequencies up to 12.5 sqrt(g/a); drag makes waves shorter

namespace whirl::models::catenary {

struct CoreCable;

int functions_for(const CoreCable& cable, int modes);
int functions_up_to(const CoreCable& cable, double omega);
/// Up to where motion can be resolved [sqrt(g/a)]; functions_up_to throws std::invalid_argument from there on.
double highest_frequency(const CoreCable& cable);

}  // namespace whirl::models::catenary
