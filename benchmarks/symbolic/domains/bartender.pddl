; Two hands fill glasses from dispensers and mix cocktails of two ingredients in a shaker.
;@ skill grasp 0 grasp ?h ?v
;@ skill leave 0 leave ?h
;@ skill fill 0 fill ?h ?d
;@ skill pour-first 0 pour-first ?h ?s ?c
;@ skill pour-second 0 pour-second ?h ?s
;@ skill rinse 0 rinse ?h
;@ skill shake 0 shake ?h
;@ skill serve 0 serve ?h ?g
(define (domain bartender)
 (:requirements :strips :typing)
 (:types hand drink vessel dispenser - object ingredient cocktail - drink glass shaker - vessel)
 (:predicates (on-bar ?v - vessel) (holding ?h - hand ?v - vessel) (free ?h - hand) (clean ?g - glass)
  (dirty ?g - glass) (contains ?g - glass ?x - drink) (dispenses ?d - dispenser ?i - ingredient)
  (first-part ?c - cocktail ?i - ingredient) (second-part ?c - cocktail ?i - ingredient) (void ?s - shaker)
  (half ?s - shaker ?c - cocktail) (full ?s - shaker ?c - cocktail) (shaken ?s - shaker ?c - cocktail))
 (:action grasp
  :parameters (?h - hand ?v - vessel)
  :precondition (and (on-bar ?v) (free ?h))
  :effect (and (holding ?h ?v) (not (on-bar ?v)) (not (free ?h))))
 (:action leave
  :parameters (?h - hand ?v - vessel)
  :precondition (and (holding ?h ?v))
  :effect (and (on-bar ?v) (free ?h) (not (holding ?h ?v))))
 (:action fill
  :parameters (?g - glass ?i - ingredient ?h ?other - hand ?d - dispenser)
  :precondition (and (holding ?h ?g) (free ?other) (clean ?g) (dispenses ?d ?i))
  :effect (and (contains ?g ?i) (not (clean ?g))))
 (:action pour-first
  :parameters (?g - glass ?i - ingredient ?h - hand ?s - shaker ?c - cocktail)
  :precondition (and (holding ?h ?g) (contains ?g ?i) (first-part ?c ?i) (void ?s))
  :effect (and (half ?s ?c) (dirty ?g) (not (contains ?g ?i)) (not (void ?s))))
 (:action pour-second
  :parameters (?g - glass ?i - ingredient ?h - hand ?s - shaker ?c - cocktail)
  :precondition (and (holding ?h ?g) (contains ?g ?i) (second-part ?c ?i) (half ?s ?c))
  :effect (and (full ?s ?c) (dirty ?g) (not (contains ?g ?i)) (not (half ?s ?c))))
 (:action rinse
  :parameters (?g - glass ?h ?other - hand)
  :precondition (and (holding ?h ?g) (free ?other) (dirty ?g))
  :effect (and (clean ?g) (not (dirty ?g))))
 (:action shake
  :parameters (?c - cocktail ?s - shaker ?h ?other - hand)
  :precondition (and (holding ?h ?s) (free ?other) (full ?s ?c))
  :effect (and (shaken ?s ?c) (not (full ?s ?c))))
 (:action serve
  :parameters (?c - cocktail ?s - shaker ?h - hand ?g - glass)
  :precondition (and (holding ?h ?s) (shaken ?s ?c) (clean ?g))
  :effect (and (contains ?g ?c) (void ?s) (not (clean ?g)) (not (shaken ?s ?c)))))
