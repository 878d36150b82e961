/* Pictures that curators send: JPEG, PNG or WebP become a JPEG or PNG that every terminal shows. */
#ifndef GOPURA_CURATOR_PAGES_PICTURE_IMPORT_H
#define GOPURA_CURATOR_PAGES_PICTURE_IMPORT_H

#include "base/bytes.h"
#include "base/diagnostics.h"

enum { PICTURE_IMPORT_SIDE_MAX_PX = 3840 }; /* larger ones are made smaller */

/* Decodes a file and encodes its pixels anew, upright (EXIF's orientation), so that nothing else of
 * the file stays: no place, no camera, no comment. PNG stays PNG, as does a WebP without loss or
 * with transparency; all else becomes JPEG. Decoders run in a process of their own that can do
 * nothing but compute (pipeline/import/sandbox.h). Appends the result; *is_png tells what it is.
 * -EBADMSG: it is none of the three, or damaged. -EFBIG: over 16384 pixels a side, or the result is
 * over 16 MB. -ENOMEM, -ETIMEDOUT. With a diagnostic. */
must_check int picture_import(struct buffer *out, bool *is_png, struct bytes file,
			      struct diagnostics *diagnostics);

/* The same in this process, for tests and the fuzzer. */
must_check int picture_import_here(struct buffer *out, bool *is_png, struct bytes file);

#endif
