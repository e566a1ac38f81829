"""What a model is worth: one file per score."""
