/* The documents of a content folder: parts.json, tours.json, and the files in pages/, pictures/
 * and regions/. Whatever gopura-curator changes of them goes through here, so that each
 * file is replaced whole or not at all, a change of several files is made whole or not at all even
 * by a program that is killed, and DIR/.curator/history.git knows who changed what, and when.
 *
 * What other programs changed meanwhile (a text editor, gopura-content) becomes a version of its
 * own before the next change, and when the folder is opened: nothing is lost. One process at a time
 * has a folder's documents; any thread, each call waits for the one before. */
#ifndef GOPURA_CURATOR_STORE_DOCUMENTS_H
#define GOPURA_CURATOR_STORE_DOCUMENTS_H

#include "curator/store/history.h"

/* The author of what other programs changed. No account has this name. */
#define DOCUMENTS_OUTSIDE "(outside)"

enum {
	DOCUMENT_TAG_BYTES = HISTORY_ID_BYTES,
	DOCUMENT_NAME_BYTES = 256,
	DOCUMENT_BYTES_MAX = 256 << 20, /* larger files are no documents */
	DOCUMENTS_CHANGES_MAX = 80,     /* a part and its pages in all languages */
};

struct documents;

/* A change of one document. */
struct document_change {
	const char *name; /* borrowed */
	struct bytes text;
	bool removes; /* the document; text is not used */
	/* The tag of the text that the change began from; "": there was none; NULL: it does not
	 * matter what is there. */
	const char *base;
	char tag[DOCUMENT_TAG_BYTES]; /* result: of the text that is there now; "": removed */
};

/* Opens a folder, finishes what a killed program began, and takes in what others changed. folder is
 * copied. *out is owned by the caller; NULL on failure. -EBUSY: another process has it. All with a
 * diagnostic. */
must_check int documents_open(struct documents **out, const char *folder,
			      struct diagnostics *diagnostics);
void documents_close(struct documents *documents); /* NULL is fine */

/* Returns whether a name may be that of a document, as "pages/gate.en.html". */
bool document_name_is_valid(const char *name);

/* Keeps other threads out from reading a document to saving what was made of it. May be nested. */
void documents_lock(struct documents *documents);
void documents_unlock(struct documents *documents);

/* Reads a document into *text, which is cleared first, and its tag. -ENOENT: there is none; tag is
 * then "". -EINVAL: the name. -EFBIG past the buffer's ceiling. With a diagnostic, but for -ENOENT.
 */
must_check int documents_read(struct documents *documents, const char *name, struct buffer *text,
			      char tag[DOCUMENT_TAG_BYTES], struct diagnostics *diagnostics);

/* Makes 1 to DOCUMENTS_CHANGES_MAX changes, all or none. author: an account; "": nobody signed in.
 * what: a line for people, as "page of gate in English". -ESTALE: the text is no longer that of
 * base; the tag of that change is then that of the text which is there. Errors of the disk. All
 * with a diagnostic. */
must_check int documents_save(struct documents *documents, struct document_change *changes,
			      uint32_t count, const char *author, const char *what,
			      struct diagnostics *diagnostics);

/* Calls for each document that is there, by name; a negative result ends it and is returned. */
must_check int documents_each(struct documents *documents,
			      int (*call)(void *user, const char *name, const char *tag),
			      void *user, struct diagnostics *diagnostics);

#endif
