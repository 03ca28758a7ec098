; A robot with several grippers carries balls between rooms.
;@ skill move 0 move ?to
;@ skill pick 0 pick ?b ?g
;@ skill drop 0 drop ?b ?g
(define (domain gripper)
 (:requirements :strips :typing)
 (:types room ball gripper)
 (:predicates (at-robot ?r - room) (at ?b - ball ?r - room) (free ?g - gripper) (carries ?g - gripper ?b - ball))
 (:action move
  :parameters (?from ?to - room)
  :precondition (and (at-robot ?from))
  :effect (and (at-robot ?to) (not (at-robot ?from))))
 (:action pick
  :parameters (?b - ball ?r - room ?g - gripper)
  :precondition (and (at ?b ?r) (at-robot ?r) (free ?g))
  :effect (and (carries ?g ?b) (not (at ?b ?r)) (not (free ?g))))
 (:action drop
  :parameters (?b - ball ?r - room ?g - gripper)
  :precondition (and (carries ?g ?b) (at-robot ?r))
  :effect (and (at ?b ?r) (free ?g) (not (carries ?g ?b)))))
