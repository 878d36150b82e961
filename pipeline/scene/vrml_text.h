/* The text of a VRML file from its bytes. */
#ifndef GOPURA_PIPELINE_SCENE_VRML_TEXT_H
#define GOPURA_PIPELINE_SCENE_VRML_TEXT_H

#include "base/bytes.h"

enum { VRML_TEXT_BYTES_MAX = 256 << 20 };

/* Appends the text to *out, which ends with a zero byte; gzip'd files are unpacked. out's ceiling
 * is to be VRML_TEXT_BYTES_MAX or more. Returns 0; -EBADMSG: a damaged gzip file, or a zero byte
 * within the text; -EFBIG: past the ceiling; -ENOMEM. */
must_check int vrml_text(struct buffer *out, struct bytes file);

#endif
