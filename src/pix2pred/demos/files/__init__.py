"""The files of a project folder as text: documents, problems by line, schemas."""
