-- Fills the words of notes.
INSERT INTO event_words(event_words) VALUES ('delete-all');
INSERT INTO event_words(rowid, words) SELECT seq, search_words(body) FROM fault_event
  WHERE kind NOT IN ('opened', 'recurred') AND body <> '';
INSERT INTO note_words(note_words) VALUES ('delete-all');
INSERT INTO note_words(rowid, words) SELECT seq, search_words(text) FROM run_note;
