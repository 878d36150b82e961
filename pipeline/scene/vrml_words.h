/* Makes flat letters of VRML97's Text (ISO/IEC 14772-1, 6.20 and 6.47): Pango shapes them in the
 * fonts of this machine, and their outlines are filled with triangles. Private to pipeline/scene.
 */
#ifndef GOPURA_PIPELINE_SCENE_VRML_WORDS_H
#define GOPURA_PIPELINE_SCENE_VRML_WORDS_H

#include "base/diagnostics.h"
#include "pipeline/scene/soup.h"
#include "pipeline/scene/vrml.h"

/* As vrml_faces_add. -EBADMSG also for a string that is not UTF-8, or whose letters have more than
 * TRIM_EDGES_MAX edges. */
must_check int vrml_words_add(struct soup *soup, const struct vrml_node *text, const uint8_t rgb[3],
			      struct diagnostics *diagnostics);

#endif
