/* Reads the condition of a save, and adds the list of problems to an answer. */
#include "curator/pages/save_answer.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <string.h>

#include "base/json_tree.h"
#include "curator/pages/content_save.h"

int save_base_read(const struct api_request *request, struct api_response *response,
		   char base[DOCUMENT_TAG_BYTES])
{
	const size_t bytes = strlen(request->if_match);

	base[0] = '\0';
	if (strcmp(request->if_none_match, "*") == 0)
		return 0;
	if (bytes == DOCUMENT_TAG_BYTES + 1 && request->if_match[0] == '"' &&
	    request->if_match[bytes - 1] == '"') {
		memcpy(base, request->if_match + 1, DOCUMENT_TAG_BYTES - 1);
		base[DOCUMENT_TAG_BYTES - 1] = '\0';
		return 0;
	}
	api_fail(response, 428, "what is saved names the version that it began from (If-Match)");
	return -EINVAL;
}

void save_answer_fail(struct api_response *response, int rc, const struct diagnostics *problems)
{
	int status;
	cJSON *json;

	api_fail_with(response, rc, problems);
	if (rc != -EINVAL)
		return;
	status = response->status;
	json = cJSON_CreateObject();
	cJSON_AddStringToObject(json, "message", diagnostics_cause(problems, rc));
	json_add(json, "problems", content_problems(problems, ""));
	response->status = status;
	api_send_json(response, json);
}
