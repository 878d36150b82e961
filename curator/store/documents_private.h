/* What documents.c and documents_versions.c share. Private to curator/store. */
#ifndef GOPURA_CURATOR_STORE_DOCUMENTS_PRIVATE_H
#define GOPURA_CURATOR_STORE_DOCUMENTS_PRIVATE_H

#include <pthread.h>

#include "curator/store/folder_files.h"
#include "pipeline/content/content.h"

enum { PATH_BYTES = CONTENT_PATH_BYTES + DOCUMENT_NAME_BYTES };

struct documents {
	char folder[CONTENT_PATH_BYTES];
	int lock_fd;
	pthread_mutex_t mutex;     /* recursive */
	struct history *history;   /* owned */
	struct folder_files files; /* of the history's newest version */
};

/* Adds a diagnostic for a negative errno, and returns it; 0: adds nothing. */
int documents_report(struct diagnostics *diagnostics, int rc, const char *name);
/* Makes a version of what other programs changed. Under the lock. */
must_check int documents_take_in(struct documents *documents, struct diagnostics *diagnostics);

#endif
