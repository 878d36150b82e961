/* One file of the server's folder tuf/, by the name that the kiosk gives: the fetcher does not know
 * what is in it. Where the server does not answer, it is asked again until it does. One thread. */
#ifndef GOPURA_NET_ASKED_FILE_H
#define GOPURA_NET_ASKED_FILE_H

#include "format/message.h"
#include "net/http.h"
#include "net/link.h"

struct asked_file; /* private to asked_file.c */

struct asked_file_options {
	struct http *http; /* borrowed, like link */
	struct link *link;
	/* The server's answer; everything in *file is borrowed for the call. */
	void (*answered)(void *data, const struct message_file *file);
	void *data;
};

/* *out is owned by the caller. -ENOMEM. */
must_check int asked_file_create(struct asked_file **out, const struct asked_file_options *options);
/* Cancels a request in flight. NULL is fine. */
void asked_file_destroy(struct asked_file *asked);

/* Asks for a file; *file is copied. An earlier one that was not answered is dropped, unless it is
 * the same. */
void asked_file_want(struct asked_file *asked, const struct message_file *file);
void asked_file_drop(struct asked_file *asked); /* Asks for nothing any more. */
/* Does all work that is due now. */
void asked_file_work(struct asked_file *asked);
/* Returns when asked_file_work has work to do, like downloader_due_ms. */
int64_t asked_file_due_ms(const struct asked_file *asked);

#endif
