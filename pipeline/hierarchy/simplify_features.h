/* Shape-preserving simplification (paper P3, section 3.5): half-edge collapses that leave the
 * features of the surface (feature_edges.h) in their places. It differs from simplify.h in this:
 *
 * - A collapse moves no vertex: one end is removed, on the flatter side, and the other is
 * unchanged.
 * - What is collapsed first depends on normals alone: the flattest edge, then the shortest.
 * - It works in passes. A pass finds the features anew and collapses edges in their order, except
 *   where this pass changed the surface already.
 * - The paper keeps one epsilon and stops when no edge is left. Here a level must get coarse. So
 *   there are rounds, each of which may lose more than the one before; and in each, passes that
 *   keep all features (epsilon 0.9), then those that keep strong ones (0.5) but may lose a quarter
 *   of that, then those that keep none and may lose a 16th. So a small feature goes before a large
 *   shape does. Losses are those of quadrics, one evaluation for a collapse.
 *
 * A vertex on two sharp edges may only leave along one of them, if the line is straight enough.
 * Ends of base edges, corners and locked vertices stay. No triangle folds over and the link
 * condition holds; at the very end it is given up, as in simplify.h. Deterministic. */
#ifndef GOPURA_PIPELINE_HIERARCHY_SIMPLIFY_FEATURES_H
#define GOPURA_PIPELINE_HIERARCHY_SIMPLIFY_FEATURES_H

#include "pipeline/hierarchy/simplify.h"

/* As simplify, with the same measure of errors. Stages below epsilon_least (-1..0.9) are left out:
 * features that are stronger stay, although the target is not reached then; -1: all may go. */
must_check int simplify_features(struct simplify_surface *surface, uint32_t target_triangles,
				 double error_most_steps, double epsilon_least,
				 struct simplify_result *result);

#endif
