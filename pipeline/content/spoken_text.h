/* Spoken texts of pages: pages/ID.LANGUAGE.opus, and their words in pages/ID.LANGUAGE.vtt. Private
 * to pipeline/content. docs/sound.md has the rules. */
#ifndef GOPURA_PIPELINE_CONTENT_SPOKEN_TEXT_H
#define GOPURA_PIPELINE_CONTENT_SPOKEN_TEXT_H

#include "pipeline/content/draft.h"

/* Reads and checks what is spoken on a part's page in a language (index into the release's). There
 * may be nothing; faults are added to the draft's diagnostics. -ENOMEM. */
must_check int spoken_text_read(struct draft *draft, struct draft_part *part, uint32_t language);

#endif
